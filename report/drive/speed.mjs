// node drive/speed.mjs PAGE.html: time until a page is drawn, and frames a second while it turns, in headless Chromium
// with WebGL in software: a lower bound for any machine with a graphics card. Beside the times of the clock stand those
// that the processors spent on it, which do not depend on what else the machine does.
import { statSync } from "node:fs";
import { open } from "./browser.mjs";
import { processorSeconds } from "./processors.mjs";

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
