// node drive/speed.mjs PAGE.html: time until a page is drawn, and frames a second while it turns, in headless Chromium
// with WebGL in software: a lower bound for any machine with a graphics card. Beside the times of the clock stand those
// that the processors spent on it, which do not depend on what else the machine does.
import { readFileSync, readdirSync, statSync } from "node:fs";
import { open } from "./browser.mjs";

/** Seconds that all processes below this one have taken; nothing where there is no /proc. */
function processorSeconds() {
  const parents = new Map();
  const own = new Map();
  let ids = [];
  try {
    ids = readdirSync("/proc").filter((name) => /^\d+$/.test(name));
  } catch {
    return NaN;
  }
  for (const id of ids) {
    try {
      const fields = readFileSync(`/proc/${id}/stat`, "utf8").split(") ")[1].split(" ");
      parents.set(id, fields[1]);
      own.set(id, (Number(fields[11]) + Number(fields[12])) / 100);
    } catch {
      // It has ended.
    }
  }
  let sum = 0;
  for (const id of own.keys()) {
    let at = parents.get(id);
    while (at && at !== String(process.pid)) at = parents.get(at);
    if (at) sum += own.get(id);
  }
  return sum;
}

const [file] = process.argv.slice(2);
for (let run = 0; run < 3; run++) {
  const { browser, tab, openMs, openProcessorS } = await open(file, { width: 1280, height: 900 }, processorSeconds);
  const before = processorSeconds();
  const { frames, seconds, heap } = await tab.evaluate(async () => {
    const canvas = document.querySelector(".frame canvas");
    const start = performance.now();
    let frames = 0;
    await new Promise((done) => {
      const tick = () => {
        if (performance.now() - start > 4000) return done();
        canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
        frames += 1;
        requestAnimationFrame(tick);
      };
      requestAnimationFrame(tick);
    });
    return { frames, seconds: (performance.now() - start) / 1000, heap: performance.memory?.usedJSHeapSize ?? 0 };
  });
  const perFrame = (processorSeconds() - before) / frames;
  console.log(
    `${(statSync(file).size / 1e6).toFixed(2)} MB, drawn after ${Math.round(openMs)} ms ` +
      `(processors ${openProcessorS.toFixed(2)} s), ${(frames / seconds).toFixed(1)} frames a second ` +
      `(processors ${(1000 * perFrame).toFixed(0)} ms a frame), heap ${(heap / 1e6).toFixed(0)} MB`,
  );
  await browser.close();
}
