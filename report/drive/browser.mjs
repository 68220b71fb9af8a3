// Headless Chromium. CHROMIUM names the program where it is not where Debian has it. PRIORITY is the priority of its
// processes (`prioritise`), that of others without it; a high one, which needs the right to it, leaves other programs
// of a busy machine aside.
import { existsSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { below, prioritise } from "./processors.mjs";

const PLACES = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

/** The browser, if there is one. */
export function program() {
  return process.env.CHROMIUM ?? PLACES.find((place) => existsSync(place)) ?? null;
}

/**
 * A browser with an empty tab. `complaints` gets what a page logs as an error, and every request that does not begin
 * with `own`.
 */
export async function launch(own, { width, height }) {
  const browser = await chromium.launch({
    executablePath: program(),
    headless: true,
    // A busy machine is no error.
    timeout: 0,
    // As on a machine without a graphics card: WebGL in software (SwiftShader), and the page put together by the
    // browser itself, not by SwiftShader as well. Nothing of the browser's own goes out.
    args: [
      "--no-sandbox",
      "--disable-gpu",
      "--enable-unsafe-swiftshader",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
    ],
  });
  await prefer();
  const complaints = [];
  const tab = await browser.newPage({ viewport: { width, height } });
  tab.setDefaultTimeout(0);
  tab.on("pageerror", (error) => complaints.push(String(error)));
  tab.on("console", (message) => {
    if (message.type() === "error") complaints.push(message.text());
  });
  tab.on("request", (request) => {
    const url = request.url();
    const isOwn = [own, "data:", "blob:"].some((start) => url.startsWith(start));
    if (!isOwn) complaints.push(`fetches ${url}`);
  });
  return { browser, tab, complaints };
}

/** Gives the browser its priority: once a page is open, which may have processes of its own. */
export async function prefer() {
  const { PRIORITY } = process.env;
  if (PRIORITY) for (const id of below(process.pid)) await prioritise(id, PRIORITY);
}

/** Opens a page from disk and waits until it is drawn. `processorSeconds` is asked before and after. */
export async function open(file, size, processorSeconds = () => NaN) {
  const address = pathToFileURL(resolve(file)).href;
  const { browser, tab, complaints } = await launch(address, size);
  const [start, startProcessorS] = [performance.now(), processorSeconds()];
  await tab.goto(address);
  await tab.waitForSelector("html[data-ready]");
  await settle(tab);
  await prefer();
  const [openMs, openProcessorS] = [performance.now() - start, processorSeconds() - startProcessorS];
  return { browser, tab, complaints, openMs, openProcessorS };
}

/** Says what went wrong: first, and once more at the end, so that whoever sees a part of the output sees it. */
export async function failed(step, error, more = async () => "") {
  const head = `FAILED in ${step}: ${String(error.message).split("\n")[0]}`;
  console.log(`${head}\n${error.stack}\n${await more().catch(String)}\n${head}`);
  process.exitCode = 1;
}

/** Waits until what was asked for is drawn. */
export function settle(tab) {
  return tab.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

/** The colour of a type of paths, from the middle of the first dash of its sample in the legend. */
export function colourOf(tab, kind) {
  return tab.locator(`label.kind[data-kind="${kind}"] img.sample`).evaluate(async (sample) => {
    await sample.decode();
    const g = new OffscreenCanvas(112, 40).getContext("2d");
    g.drawImage(sample, 0, 0);
    const [r, green, b] = g.getImageData(10, 20, 1, 1).data;
    return `#${[r, green, b].map((value) => value.toString(16).padStart(2, "0")).join("")}`;
  });
}

/** What Tab reaches from the top of the page, by `what` of each element. */
export async function reached(tab, count, what) {
  await tab.evaluate(() => document.activeElement?.blur());
  const names = new Set();
  for (let i = 0; i < count; i++) {
    await tab.keyboard.press("Tab");
    names.add(await tab.evaluate(what));
  }
  return names;
}

/** How many pixels of a screenshot are near each colour (`#rrggbb`): each channel within `within`. */
export async function countPixels(tab, png, colours, within = 12) {
  const url = `data:image/png;base64,${png.toString("base64")}`;
  return tab.evaluate(
    async ({ url, colours, within }) => {
      const image = new Image();
      image.src = url;
      await image.decode();
      const canvas = new OffscreenCanvas(image.width, image.height);
      const g = canvas.getContext("2d");
      g.drawImage(image, 0, 0);
      const { data } = g.getImageData(0, 0, image.width, image.height);
      return colours.map((colour) => {
        const value = parseInt(colour.slice(1), 16);
        const [r, green, b] = [value >> 16, (value >> 8) & 255, value & 255];
        let count = 0;
        for (let i = 0; i < data.length; i += 4) {
          const far = Math.max(Math.abs(data[i] - r), Math.abs(data[i + 1] - green), Math.abs(data[i + 2] - b));
          if (far <= within) count += 1;
        }
        return count;
      });
    },
    { url, colours, within },
  );
}
