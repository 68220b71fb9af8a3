// node drive/watch.mjs PROGRAM DOMAIN [FOLDER]: drives the page of `untangled watch` in headless Chromium as a viewer
// would, with a daemon and hosts that it starts, and a daemon that it ends and starts again. Prints what it saw as one
// line of JSON; the first thing that is not as it should be ends it with a line that says so, and exit code 1; without
// a browser it is 77. Pictures go to FOLDER.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { colourOf, countPixels, failed, launch, program, reached, settle } from "./browser.mjs";
import { Processes } from "./processes.mjs";

const [untangled, domain, folder] = process.argv.slice(2);
if (!program()) {
  console.log("there is no Chromium on this machine (CHROMIUM names one)");
  process.exit(77);
}
if (folder) mkdirSync(folder, { recursive: true });
const processes = new Processes(untangled, domain);
const seen = { pixels: {} };
const address = await processes.watch();
const { tab, browser, complaints } = await launch(address, { width: 1280, height: 900 });
const canvas = tab.locator(".frame canvas");
const data = (name) => tab.evaluate((name) => Number(document.documentElement.dataset[name] ?? 0), name);
const status = () => tab.locator(".status").textContent();
const row = (title, name) =>
  tab.locator("section.table", { hasText: title }).locator("tr", { hasText: name }).first().locator("td").textContent();

let doing = "";
try {
  for (const step of [waits, goesLive, pauses, paths, shape, keyboard, phone, second, stopped, restart, calm]) {
    doing = step.name;
    await step();
    if (folder) await tab.screenshot({ path: join(folder, `${step.name}.png`) });
  }
  // What has ended is no error of the page; the browser notes it all the same.
  const errors = complaints.filter((words) => !/status of 410/.test(words));
  assert.deepEqual(errors, [], "the page complains, or fetches something");
  console.log(JSON.stringify(seen));
} catch (error) {
  if (folder) await tab.screenshot({ path: join(folder, "failed.png"), fullPage: true });
  await failed(doing, error, async () => `the page says: ${await status()}; complaints: ${complaints.join("; ")}`);
} finally {
  await browser.close();
  await processes.end();
}

/**
 * Waits until something is so, however long a busy machine takes for it; what can't come any more, since a process has
 * ended, is an error at once.
 */
async function until(what, isSo) {
  for (let i = 1; !(await isSo()); i++) {
    const gone = processes.gone();
    assert.ok(gone.length === 0, `waiting until ${what}: ${gone.join(", ")}`);
    if (i % 600 === 0) console.error(`still waiting until ${what}; the page says: ${await status()}`);
    await tab.waitForTimeout(100);
  }
}

/** Without a daemon the page says so. */
async function waits() {
  await tab.goto(address);
  await until("the page says that there is no daemon", async () => (await status()).includes(domain));
}

/** With a daemon and a host frames come, without a reload. */
async function goesLive() {
  await processes.serve();
  processes.publish("gallery");
  await until("frames come", async () => (await data("frames")) > 3);
  const [first, count] = [await data("frame"), await data("frames")];
  await until("frames go on", async () => (await data("frame")) > first && (await data("frames")) > count);
  assert.match(await tab.locator("#session option").first().textContent(), /process \d+: [\d,]+ triangles/);
}

/** Space pauses; comma and full stop step; the numbers are those of the frame; the end of a pause is live again. */
async function pauses() {
  await canvas.focus();
  await tab.keyboard.press(" ");
  await until("it has paused", async () => (await tab.locator("button.pause").textContent()).includes("Go on"));
  const last = await data("frame");
  await tab.waitForTimeout(500);
  assert.equal(await data("frame"), last, "a pause stands still");
  await tab.keyboard.press(",");
  await tab.keyboard.press(",");
  const before = await data("frame");
  assert.ok(before < last, `two steps back: ${before} of ${last}`);
  assert.match(await tab.locator('output[for="past"]').textContent(), /s back/);
  assert.equal(await row("Numbers of this frame", "Frame"), String(before));
  await tab.keyboard.press(".");
  assert.ok((await data("frame")) > before, "a step forwards");
  await tab.locator("#past").focus();
  await tab.keyboard.press("End");
  assert.equal(await data("frame"), last, "the slider goes to the newest");
  await tab.locator("button.pause").click();
  await until("it is live again", async () => (await data("frame")) > last);
}

/** A path of each type that is there is chosen from the list by keys, is seen, told of, and hidden. */
async function paths() {
  await canvas.focus();
  await tab.keyboard.press(" ");
  await settle(tab);
  await tab.locator("#arrows").uncheck();
  const total = await tab.locator(".lists h3").textContent();
  assert.ok(
    total.endsWith(`(${await row("Numbers of this frame", "Paths")})`),
    `as many paths as the table says: ${total}`,
  );
  const entries = tab.locator(".entries button");
  const kinds = new Set(await entries.locator("strong").allTextContents());
  for (const kind of kinds) {
    const entry = entries.filter({ has: tab.locator(`strong:text-is("${kind}")`) }).first();
    await entry.focus();
    await tab.keyboard.press("Enter");
    assert.equal(await entry.getAttribute("aria-pressed"), "true", `${kind} is marked in the list`);
    assert.ok((await status()).startsWith(kind), `the status says ${kind}: ${await status()}`);
    assert.ok((await row("The path that is chosen", "Type")).startsWith(kind), "the table says its type");
    for (const name of ["Length", "State", "Path ", "Vertices inside"]) {
      assert.ok((await row("The path that is chosen", name)).length > 0, `the table says ${name}`);
    }
    const colour = await colourOf(tab, kind);
    await settle(tab);
    const [shown] = await countPixels(tab, await canvas.screenshot(), [colour]);
    seen.pixels[kind] = shown;
    assert.ok(shown > 60, `${kind} is seen: ${shown} pixels of ${colour}`);
    await canvas.focus();
    await tab.keyboard.press("Escape");
    const box = tab.locator(`label.kind[data-kind="${kind}"] input`);
    await box.uncheck();
    await settle(tab);
    const [hidden] = await countPixels(tab, await canvas.screenshot(), [colour]);
    assert.ok(hidden < shown, `${kind} is hidden: ${hidden} pixels of ${shown}`);
    await box.check();
  }
  assert.ok(kinds.size > 3, `several types: ${[...kinds]}`);
  await tab.locator("#arrows").check();
  await tab.keyboard.press("Home");
}

/** Corrections are arrows that can be switched off; plots have their numbers in words. */
async function shape() {
  await canvas.focus();
  await tab.keyboard.press("Home");
  await settle(tab);
  const [arrows] = await countPixels(tab, await canvas.screenshot(), ["#4a3aff"], 4);
  assert.ok(arrows > 20, `arrows are seen: ${arrows} pixels`);
  seen.pixels.arrows = arrows;
  assert.match(await tab.locator(".arrows").textContent(), /corrections, the largest [\d.,]+ \S+/);
  for (const words of ["intersecting face pairs", "contour length", "intersect", "all stages"]) {
    assert.match(
      await tab.locator(".lines li", { hasText: words }).first().textContent(),
      /[\d.]+ \(from [\d.]+/,
      words,
    );
  }
  assert.ok((await tab.locator(".plot canvas").count()) === 4, "four plots");
  await tab.locator("button.pause").click();
}

/** Tab reaches everything that can be used; arrow keys turn the picture. */
async function keyboard() {
  const found = await reached(tab, 80, () => {
    const at = document.activeElement;
    return at.closest(".entries") ? "list" : at.id || at.className || at.tagName.toLowerCase();
  });
  for (const what of ["session", "canvas", "pause", "past", "pace", "list", "up", "arrows"]) {
    const isThere = [...found].some((name) => name === what) || (what === "canvas" && found.has("canvas"));
    assert.ok(isThere, `Tab reaches ${what}: ${[...found]}`);
  }
}

/** At the width of a phone nothing is cut off, in light and in dark. */
async function phone() {
  await tab.setViewportSize({ width: 390, height: 844 });
  await settle(tab);
  const width = await tab.evaluate(() => document.scrollingElement.scrollWidth);
  assert.ok(width <= 390, `the page is not wider than a phone: ${width}`);
  const box = await canvas.boundingBox();
  assert.ok(box.width <= 390 && box.width > 300, `the picture fits: ${box.width}`);
  const back = () => tab.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await back();
  if (folder) await tab.screenshot({ path: join(folder, "light.png"), fullPage: true });
  await tab.emulateMedia({ colorScheme: "dark" });
  assert.notEqual(await back(), light, "dark is another colour");
  if (folder) await tab.screenshot({ path: join(folder, "dark.png"), fullPage: true });
  await tab.emulateMedia({ colorScheme: "light" });
  await tab.setViewportSize({ width: 1280, height: 900 });
}

/** A second session comes into the list, and is shown when it is chosen. */
async function second() {
  processes.publish("crease");
  await until("there are two sessions", async () => (await tab.locator("#session option").count()) === 2);
  const before = await data("frame");
  await tab.locator("#session").selectOption({ index: 1 });
  await until("the second session is shown", async () => (await status()).startsWith("Watching"));
  await until("its frames come", async () => (await data("frame")) > 0 && (await data("frame")) !== before);
}

/** A daemon that does not answer for a while has no list; when it goes on, so does the session that was chosen. */
async function stopped() {
  const chosen = await tab.locator("#session").inputValue();
  processes.daemon.kill("SIGSTOP");
  const first = tab.locator("#session option").first();
  await until("the page has no list of sessions", async () => (await first.textContent()) === "none yet");
  processes.daemon.kill("SIGCONT");
  await until("there are two sessions again", async () => (await tab.locator("#session option").count()) === 2);
  assert.equal(await tab.locator("#session").inputValue(), chosen, "the session that was chosen is shown again");
  const count = await data("frames");
  await until("its frames come again", async () => (await data("frames")) > count + 2);
  await tab.locator("#session").selectOption({ index: 0 });
}

/** A daemon that ends is said, and one that is started again goes on, without a reload. */
async function restart() {
  const lost = await data("lost");
  await processes.endDaemon();
  await until("the page says that nothing comes", async () => (await data("lost")) > lost);
  await processes.serve();
  const count = await data("frames");
  await until("frames come again", async () => (await data("frames")) > count + 2);
}

/** Where the system asks for little motion, there is one frame a second. */
async function calm() {
  await tab.emulateMedia({ reducedMotion: "reduce" });
  await tab.reload();
  await until("frames come after a reload", async () => (await data("frames")) > 0);
  assert.equal(await tab.locator("#pace").inputValue(), "1");
}
