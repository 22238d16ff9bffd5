import assert from "node:assert/strict";
import { test } from "node:test";
import { build } from "esbuild";

// Bundled without three.js, which needs a browser.
const { outputFiles } = await build({ entryPoints: ["services/gateway/page/src/surface.js"], bundle: true, write: false, format: "esm" });
