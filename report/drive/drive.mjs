// node drive/drive.mjs PAGE.html [FOLDER]: drives a page in headless Chromium as a reader would, without a mouse where
// that is the point, and compares what it shows with the JSON inside of it. Prints what it saw as one line of JSON; the
// first thing that is not as it should be ends it with a line that says so, and exit code 1; without a browser it is
// 77. Pictures go to FOLDER.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { colourOf, countPixels, failed, open, program, reached, settle } from "./browser.mjs";

const [file, folder] = process.argv.slice(2);
if (!program()) {
  console.log("there is no Chromium on this machine (CHROMIUM names one)");
  process.exit(77);
}
const { tab, browser, complaints, openMs } = await open(file, { width: 1280, height: 900 });
if (folder) mkdirSync(folder, { recursive: true });
const seen = { openMs: Math.round(openMs), pixels: {} };
const canvas = tab.locator(".frame canvas");
const data = JSON.parse(await tab.locator("#data").textContent());
const states = data.states.map((state) => ({ ...state, paths: state.paths ?? data.report.paths }));
const shot = async (name) => {
  await settle(tab);
  const png = await canvas.screenshot();
  if (folder && name) await tab.screenshot({ path: join(folder, `${name}.png`), fullPage: name === "phone" });
  return png;
};

let doing = "";
try {
  await shot("open");
  const isFixed = states.length > 1;
  const steps = [legend, paths, ...(isFixed ? [slider] : []), ...(data.sequence ? [scrubber] : [])];
  for (const step of [...steps, table, keyboard, phone, print]) {
    doing = step.name;
    await step();
  }
  assert.deepEqual(complaints, [], "the page complains, or fetches something");
  console.log(JSON.stringify(seen));
} catch (error) {
  await failed(doing, error);
} finally {
  await browser.close();
}

/** Every type that occurs stands in the legend with a sample; hiding a type takes its lines away. */
async function legend() {
  const all = data.sequence ? data.sequence.frames.flatMap((frame) => frame.states) : states;
  const kinds = new Set(all.flatMap((state) => state.paths.map((path) => path.pair_type)));
  const shown = await tab.locator("label.kind[data-kind]").evaluateAll((all) => all.map((one) => one.dataset.kind));
  assert.deepEqual(new Set(shown), kinds, "the legend has the types of the report");
  const samples = await tab.locator("label.kind[data-kind] img.sample").count();
  assert.equal(samples, kinds.size, "each type has a sample");
}

/** The pixels of each type: a path of it that was chosen from the list is seen, and is not when the type is hidden. */
async function paths() {
  const first = states[0];
  for (const kind of new Set(first.paths.map((path) => path.pair_type))) {
    const longest = [...first.paths]
      .filter((path) => path.pair_type === kind)
      .sort((a, b) => b.length_m - a.length_m)[0];
    const entry = tab.locator(`section[data-state="${first.name}"] .entries button`, { hasText: kind }).first();
    await entry.focus();
    await tab.keyboard.press("Enter");
    assert.equal(await entry.getAttribute("aria-pressed"), "true", `${kind} is marked in the list`);
    const status = await tab.locator(".status").textContent();
    assert.ok(status.startsWith(kind), `the status says ${kind}: ${status}`);
    const colour = await colourOf(tab, kind);
    const picked = await shot(`path-${kind.replace("/", "-")}`);
    const [seenPixels] = await countPixels(tab, picked, [colour]);
    seen.pixels[kind] = seenPixels;
    assert.ok(seenPixels > 60, `${kind} (${longest.length_m} m) is seen: ${seenPixels} pixels of ${colour}`);
    await canvas.focus();
    await tab.keyboard.press("Escape");
    await tab.locator(`label.kind[data-kind="${kind}"] input`).uncheck();
    const [hidden] = await countPixels(tab, await shot(), [colour]);
    assert.ok(hidden < seenPixels / 5, `${kind} is hidden: ${hidden} pixels of ${seenPixels}`);
    await tab.locator(`label.kind[data-kind="${kind}"] input`).check();
    // What was chosen is in the middle of the picture: a click there chooses it again.
    await entry.click();
    await canvas.focus();
    await tab.keyboard.press("Escape");
    const box = await canvas.boundingBox();
    await tab.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    const again = await tab.locator(".status").textContent();
    assert.ok(
      first.paths.some((path) => again.startsWith(path.pair_type)),
      `a click chooses a path: ${again}`,
    );
    await canvas.focus();
    await tab.keyboard.press("Escape");
    await tab.keyboard.press("Home");
  }
}

/** The slider goes by keys from before to after, and the picture with it. */
async function slider() {
  await canvas.focus();
  await tab.keyboard.press("Home");
  await tab.locator("#slider").focus();
  await tab.keyboard.press("Home");
  const before = await shot("before");
  await tab.keyboard.press("End");
  assert.equal(await tab.locator("#slider").getAttribute("aria-valuetext"), "after");
  const after = await shot("after");
  // Of a sequence the first frame is shown.
  const isMoved = data.sequence
    ? data.sequence.frames[0].line.num_moved_vertices > 0
    : data.report.distortion.num_moved_vertices > 0;
  assert.ok(!isMoved || !before.equals(after), "the picture changes where the mesh did");
  await tab.keyboard.press("PageDown");
  assert.match(await tab.locator('output[for="slider"]').textContent(), /% of the way/);
  await tab.keyboard.press("End");
  for (const map of ["moved", "stretch"]) {
    await tab.locator("#map").selectOption(map);
    const coloured = await shot(map);
    assert.ok(!coloured.equals(after), `the cloth is coloured by ${map}`);
    assert.equal(await tab.locator(".map .ticks span").count(), 5, "the legend has ticks");
    assert.match(await tab.locator(".map .ticks").textContent(), map === "moved" ? / (m|mm|µm)/ : /×/);
  }
  await tab.locator("#map").selectOption("");
}

/** The scrubber goes from frame to frame, and the list with it. */
async function scrubber() {
  const { frames } = data.sequence;
  const scrub = tab.locator("#frame");
  await scrub.focus();
  await tab.keyboard.press("Home");
  const first = await shot("first-frame");
  await tab.keyboard.press("End");
  const last = await shot("last-frame");
  assert.ok(!first.equals(last), "the picture changes from frame to frame");
  assert.equal(await scrub.getAttribute("aria-valuetext"), `frame ${frames.at(-1).frame}`);
  const counts = frames.map(({ states: [state] }) => state.paths.length);
  const worst = counts.indexOf(Math.max(...counts));
  await tab.keyboard.press("Home");
  for (let i = 0; i < worst; i++) await tab.keyboard.press("ArrowRight");
  const title = await tab.locator(`section[data-state="${states[0].name}"] h3`).textContent();
  assert.ok(title.endsWith(`(${counts[worst]})`), `the list is that of the frame: ${title}, ${counts[worst]}`);
  if (counts[worst] === 0) return;
  const entry = tab.locator(`section[data-state="${states[0].name}"] .entries button`).first();
  const kind = await entry.locator("strong").textContent();
  await entry.focus();
  await tab.keyboard.press("Enter");
  const [pixels] = await countPixels(tab, await shot("worst-frame"), [await colourOf(tab, kind)]);
  assert.ok(pixels > 60, `${kind} is seen in frame ${frames[worst].frame}: ${pixels} pixels`);
  seen.pixels[kind] = pixels;
}

/** The tables say what the JSON says. */
async function table() {
  const counts = [
    ["Triangles", data.report.num_faces],
    ["Intersecting face pairs", data.report.num_face_pairs ?? data.report.before?.num_face_pairs],
  ];
  for (const [name, value] of counts.filter(([, value]) => value !== undefined)) {
    const cell = tab
      .locator(".tables tr", { has: tab.locator(`th:text-is("${name}")`) })
      .first()
      .locator("td")
      .first();
    assert.equal(await cell.textContent(), value.toLocaleString("en"), name);
  }
  for (const { name, value } of data.settings) {
    const row = tab.locator(".tables tr", { has: tab.locator(`th:text-is("${name}")`) }).first();
    assert.equal(await row.locator("td").first().textContent(), value, name);
  }
  assert.ok((await tab.locator(".tables").textContent()).includes(`untangled ${data.version}`), "the version is there");
  for (const blocked of data.report.blocked ?? []) {
    assert.ok((await tab.locator(".blocked").textContent()).includes(blocked.reason), "each reason is there");
  }
}

/** Tab reaches the picture, the controls and the list; arrow keys turn the picture. */
async function keyboard() {
  const found = await reached(tab, 60, () => {
    const at = document.activeElement;
    return at.closest(".entries") ? "list" : at.tagName.toLowerCase();
  });
  const wanted = states.some((state) => state.paths.length > 0) ? ["canvas", "button", "list"] : ["canvas", "button"];
  for (const what of wanted) assert.ok(found.has(what), `Tab reaches ${what}: ${[...found]}`);
  await canvas.focus();
  await tab.keyboard.press("Home");
  const still = await shot();
  await tab.keyboard.press("ArrowLeft");
  assert.ok(!still.equals(await shot()), "arrow keys turn the picture");
  await tab.keyboard.press("Home");
}

/** At the width of a phone nothing is cut off, in light and in dark. */
async function phone() {
  await tab.setViewportSize({ width: 390, height: 844 });
  await settle(tab);
  const width = await tab.evaluate(() => document.scrollingElement.scrollWidth);
  assert.ok(width <= 390, `the page is not wider than a phone: ${width}`);
  const box = await canvas.boundingBox();
  assert.ok(box.width <= 390 && box.width > 300, `the picture fits: ${box.width}`);
  await shot("phone");
  const back = () => tab.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await back();
  await tab.emulateMedia({ colorScheme: "dark" });
  assert.notEqual(await back(), light, "dark is another colour");
  await tab.setViewportSize({ width: 1280, height: 900 });
  await shot("dark");
  await tab.emulateMedia({ colorScheme: "light" });
}

/** Printed, there is a still picture and the tables. */
async function print() {
  const pdf = await tab.pdf({ path: folder ? join(folder, "print.pdf") : undefined });
  assert.ok(pdf.length > 10_000, "it prints");
  await tab.emulateMedia({ media: "print" });
  assert.ok(await tab.locator(".still").isVisible(), "the still picture is printed");
  assert.ok(await tab.locator(".tables table").first().isVisible(), "the tables are printed");
  assert.ok(!(await canvas.isVisible()), "the live picture is not");
  await tab.emulateMedia({ media: "screen" });
}
