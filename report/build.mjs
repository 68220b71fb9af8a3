// Builds built/page.js and built/page.css, which src/cli/html takes into the program. Same sources and lock file, same
// bytes. `node build.mjs FOLDER` writes into another folder, to compare.
import { build } from "esbuild";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "built");
const licence = await readFile(join(here, "node_modules/three/LICENSE"), "utf8");
const notice = `/*!\nThis script contains three.js, https://threejs.org:\n\n${licence.trim()}\n*/\n`;

const shared = {
  bundle: true,
  minify: true,
  write: false,
  charset: "utf8",
  legalComments: "none",
  logLevel: "warning",
  absWorkingDir: here,
};
const script = await build({
  ...shared,
  entryPoints: ["src/main.ts"],
  format: "iife",
  target: ["es2022"],
  define: { __THREE_DEVTOOLS__: "undefined" },
});
const style = await build({
  ...shared,
  entryPoints: ["src/page.css"],
  target: ["chrome120", "firefox121", "safari17"],
});
const text = script.outputFiles[0].text;
// The browser would take these for the end of the script, or for a comment.
for (const end of ["</script", "<!--", "<script"]) {
  if (text.toLowerCase().includes(end)) throw new Error(`the script contains ${end}`);
}
await mkdir(out, { recursive: true });
await writeFile(join(out, "page.js"), notice + text);
await writeFile(join(out, "page.css"), style.outputFiles[0].text);
