// node drive/rate.mjs PROGRAM [EDGE_M [SECONDS [RUNS]]]: frames a second in the page of `untangled watch`, and the
// round trips of the session that it shows, with the page and without it in turn. Headless Chromium, WebGL in software:
// a lower bound for any machine with a graphics card. The host simulates the gallery with edges of EDGE_M metres.
import { createInterface } from "node:readline";
import { launch } from "./browser.mjs";
import { processorSeconds, processSeconds } from "./processors.mjs";
import { Processes } from "./processes.mjs";

const [untangled, edge = "0.0114", seconds = "20", runs = "3"] = process.argv.slice(2);
const processes = new Processes(untangled, `rate-${process.pid}`);
let trips = [];

await processes.serve();
const args = [
  "--edge-m",
  edge,
  "--no-corrections",
  "--frames",
  "1000000",
  "--clean-frames",
  "0",
  "--report-every",
  "1",
];
const host = processes.start(["publish", "--scene", "gallery", ...args], ["ignore", "pipe", "inherit"]);
processes.hosts.push(host);
const said = createInterface({ input: host.stdout });
said.on("line", (text) => {
  const ms = /round trip +([\d.]+) ms/.exec(text)?.[1];
  if (ms) trips.push(Number(ms));
  else console.log(text);
});
await new Promise((done) => said.once("line", done));
const address = await processes.watch();
try {
  for (let run = 0; run < Number(runs); run++) {
    console.log(`without: ${await session(sleep)}`);
    console.log(`with:    ${await session(page)}`);
  }
} finally {
  await processes.end();
}

/** What the host measured while something was done. */
async function session(work) {
  trips = [];
  const [start, ticks] = [performance.now(), processSeconds(processes.daemon.pid)];
  const words = await work();
  const [own, took] = [trips.toSorted((a, b) => a - b), (performance.now() - start) / 1000];
  const at = (part) => own[Math.floor(part * (own.length - 1))]?.toFixed(2);
  const each = (1000 * (processSeconds(processes.daemon.pid) - ticks)) / Math.max(1, own.length);
  return (
    `${words}; session ${(own.length / took).toFixed(1)} frames a second, round trip median ${at(0.5)} ms, ` +
    `nine in ten below ${at(0.9)} ms, processors ${each.toFixed(1)} ms of the daemon a frame`
  );
}

async function sleep() {
  await new Promise((done) => setTimeout(done, 1000 * Number(seconds)));
  return "no page";
}

/** Frames a second in a page that is open all the time, and what it and its server take for each. */
async function page() {
  const { browser, tab } = await launch(address, { width: 1280, height: 900 });
  await tab.goto(address);
  await tab.waitForSelector("html[data-ready]", { timeout: 120_000 });
  const others = [processes.daemon, processes.page, ...processes.hosts];
  const look = async () => {
    const own = others.map(({ pid }) => processSeconds(pid));
    return {
      frames: await tab.evaluate(() => Number(document.documentElement.dataset.frames)),
      at: performance.now() / 1000,
      browser: own.reduce((left, seconds) => left - seconds, processorSeconds()),
      server: own[1],
    };
  };
  const before = await look();
  await sleep();
  const after = await look();
  await browser.close();
  const frames = after.frames - before.frames;
  const each = (name) => ((1000 * (after[name] - before[name])) / frames).toFixed(0);
  return (
    `page ${(frames / (after.at - before.at)).toFixed(1)} frames a second, each ${each("browser")} ms of the browser ` +
    `and ${each("server")} ms of untangled watch on the processors`
  );
}
