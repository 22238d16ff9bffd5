// Bundles the page into one script, for `npm run build -- --outdir=FOLDER --registry=FILE`.
import { build } from "esbuild";
import { copyFile, mkdir, readFile } from "node:fs/promises";
import { join } from "node:path";

const option = (name) => process.argv.find((argument) => argument.startsWith(`--${name}=`))?.slice(name.length + 3);
const outdir = option("outdir") ?? "dist";

/** The strategies that the explorer offers, from its table in services/explorer/core/strategy/registry.cpp. */
function strategiesIn(source) {
  const lines = [...source.matchAll(/Line<\w+>\(\s*"(\w+)",\s*"([^"]+)"/g)];
  if (lines.length === 0) throw new Error("the table of strategies has no line of the known form");
  return lines.map(([, name, summary]) => ({ name, summary }));
}
const registry = option("registry");
if (!registry) throw new Error("--registry=FILE is missing: the explorer's table of strategies");
const strategies = strategiesIn(await readFile(registry, "utf8"));
await mkdir(outdir, { recursive: true });
await build({
  entryPoints: ["src/main.js"],
  outfile: join(outdir, "page.js"),
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  define: { STRATEGIES: JSON.stringify(strategies) },
  legalComments: "linked",
  logLevel: "warning",
});
for (const file of ["style.css", "index.html"]) await copyFile(file, join(outdir, file));
