// Builds the script and the style of both pages, which src/cli/html and src/cli/watch take into the program, into
// built. Same sources and lock file, same bytes. `node build.mjs FOLDER` writes into another folder, to compare.
import { build } from "esbuild";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "built");
const PAGES = [
  { name: "page", script: "src/main.ts", libraries: [["three.js", "https://threejs.org", "three"]] },
  {
    name: "watch",
    script: "src/watch/main.ts",
    libraries: [
      ["three.js", "https://threejs.org", "three"],
      ["uPlot", "https://github.com/leeoniya/uPlot", "uplot"],
    ],
  },
];

/** The licences of libraries, as a comment. */
async function notice(libraries) {
  const parts = libraries.map(async ([name, address, folder]) => {
    const licence = await readFile(join(here, "node_modules", folder, "LICENSE"), "utf8");
    return `This script contains ${name}, ${address}:\n\n${licence.trim()}\n`;
  });
  return `/*!\n${(await Promise.all(parts)).join("\n")}*/\n`;
}

const shared = {
  bundle: true,
  minify: true,
  write: false,
  charset: "utf8",
  legalComments: "none",
  logLevel: "warning",
  absWorkingDir: here,
};
await mkdir(out, { recursive: true });
for (const { name, script, libraries } of PAGES) {
  const built = await build({
    ...shared,
    entryPoints: [script],
    format: "iife",
    target: ["es2022"],
    define: { __THREE_DEVTOOLS__: "undefined" },
  });
  const style = await build({
    ...shared,
    entryPoints: [`src/${name}.css`],
    target: ["chrome123", "firefox121", "safari17.5"],
  });
  const text = built.outputFiles[0].text;
  // The browser would take these for the end of the script, or for a comment.
  for (const end of ["</script", "<!--", "<script"]) {
    if (text.toLowerCase().includes(end)) throw new Error(`the script contains ${end}`);
  }
  await writeFile(join(out, `${name}.js`), (await notice(libraries)) + text);
  await writeFile(join(out, `${name}.css`), style.outputFiles[0].text);
}
