// Bundles the page into one script, for `npm run build -- --outdir=FOLDER`.
import { build } from "esbuild";
import { copyFile, mkdir } from "node:fs/promises";
import { join } from "node:path";

const option = process.argv.find((argument) => argument.startsWith("--outdir="));
const outdir = option ? option.slice("--outdir=".length) : "dist";
await mkdir(outdir, { recursive: true });
await build({
  entryPoints: ["src/main.js"],
  outfile: join(outdir, "page.js"),
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "linked",
  logLevel: "warning",
});
for (const file of ["style.css", "index.html"]) await copyFile(file, join(outdir, file));
