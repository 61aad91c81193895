// Bundles the script, the styles and the frame of the page into the directory that is named.
import { build } from "esbuild";
import { copyFile, mkdir } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const [, , into] = process.argv;
if (!into) throw new Error("build.mjs DIRECTORY");
await mkdir(into, { recursive: true });
await build({
  entryPoints: [join(here, "src/main.ts")],
  outfile: join(into, "view.js"),
  bundle: true,
  minify: true,
  charset: "ascii",
  format: "iife",
  target: ["es2022"],
  legalComments: "none",
});
await build({
  entryPoints: [join(here, "view.css")],
  outfile: join(into, "view.css"),
  minify: true,
  charset: "ascii",
});
await copyFile(join(here, "view.html"), join(into, "view.html"));
