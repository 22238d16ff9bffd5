// Bundles the page into one script, for `npm run build -- --outdir=FOLDER --registry=FILE`.
import { build, transform } from "esbuild";
import { copyFile, mkdir, readdir, readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";

const option = (name) => process.argv.find((argument) => argument.startsWith(`--${name}=`))?.slice(name.length + 3);
const outdir = option("outdir") ?? "dist";

/** The strategies that the explorer offers, from its table in services/explorer/core/strategy/registry.cpp. */
function strategiesIn(source) {
  const lines = [...source.matchAll(/Line(?:Of)?<[^>]+>\(\s*"(\w+)",\s*"([^"]+)"/g)];
  if (lines.length === 0) throw new Error("the table of strategies has no line of the known form");
  return lines.map(([, name, summary]) => ({ name, summary }));
}
const registry = option("registry");
if (!registry) throw new Error("--registry=FILE is missing: the explorer's table of strategies");
const strategies = strategiesIn(await readFile(registry, "utf8"));
const reportdir = option("reportdir");
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
await requireWholeStyles(".");
if (reportdir) {
  await requireWholeStyles("report");
  await bundleReport(reportdir);
}
for (const file of ["style.css", "index.html"]) await copyFile(file, join(outdir, file));

/** Browsers read past mistakes of a style sheet, and what follows them is lost without a word. */
async function requireWholeStyles(folder) {
  for (const file of (await readdir(folder)).filter((name) => name.endsWith(".css"))) {
    const { warnings } = await transform(await readFile(join(folder, file), "utf8"), { loader: "css", logLevel: "silent" });
    for (const { text, location } of warnings) throw new Error(`${file}:${location?.line}: ${text}`);
  }
}

/** Bundles the report of a run, from report/ beside this file, into one page without references to others. */
async function bundleReport(folder) {
  const { outputFiles } = await build({
    entryPoints: ["report/run.js"],
    bundle: true,
    write: false,
    minify: true,
    format: "iife",
    target: "es2022",
    alias: { gateway: "./src" },
    legalComments: "eof",
    logLevel: "warning",
  });
  const script = outputFiles[0].text.replaceAll("</script", "<\\/script");
  const [page, ...styles] = await Promise.all(
    ["report/run.html", "style.css", "report/page.css", "report/run.css"].map((file) => readFile(file, "utf8")));
  await mkdir(folder, { recursive: true });
  await writeFile(join(folder, "report.html"),
    page.replace("/* STYLE */", () => styles.join("\n")).replace("/* SCRIPT */", () => script));
}
