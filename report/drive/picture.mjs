// node drive/picture.mjs [SIDE [SECONDS]]: what a frame of the live page takes in headless Chromium, WebGL in software:
// processor time of the browser, of it that of the page's script. The session is made up: 2 SIDE^2 triangles, and
// frames that are there as fast as the page asks.
import { launch, prefer } from "./browser.mjs";
import { MadeUp } from "./made-up.mjs";
import { processorSeconds } from "./processors.mjs";

const [side = "125", seconds = "10"] = process.argv.slice(2);
const { address, end } = await new MadeUp(Number(side)).serve();
const { browser, tab } = await launch(address, { width: 1280, height: 900 });
const client = await tab.context().newCDPSession(tab);
await client.send("Performance.enable");
await tab.goto(address);
await tab.waitForSelector("html[data-ready]");
await prefer();
const look = async () => {
  const { metrics } = await client.send("Performance.getMetrics");
  const metric = (name) => metrics.find((one) => one.name === name).value;
  return {
    frames: await tab.evaluate(() => Number(document.documentElement.dataset.frames)),
    at: performance.now() / 1000,
    browser: processorSeconds(),
    heap: metric("JSHeapUsedSize"),
    script: metric("ScriptDuration"),
    layout: metric("LayoutDuration") + metric("RecalcStyleDuration"),
    main: metric("TaskDuration"),
  };
};
// Until the picture is as coarse as it gets.
await tab.waitForTimeout(4000);
const before = await look();
await tab.waitForTimeout(1000 * Number(seconds));
const after = await look();
const frames = after.frames - before.frames;
const each = (name) => `${((1000 * (after[name] - before[name])) / frames).toFixed(0)} ms`;
console.log(
  `${2 * Number(side) ** 2} triangles: ${(frames / (after.at - before.at)).toFixed(1)} frames a second; ` +
    `of the browser's processors ${each("browser")} a frame; by the clock ${each("main")} of the page's thread, ` +
    `of which ${each("script")} script and ${each("layout")} layout; ` +
    `${(after.heap / 1e6).toFixed(0)} MB of its heap, besides the frames of the last seconds`,
);
await browser.close();
end();
