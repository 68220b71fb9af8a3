// node drive/rate.mjs PROGRAM [EDGE_M [SECONDS [RUNS]]]: frames a second in the page of `untangled watch`, and the
// round trips of the session that it shows, with the page and without it in turn. Headless Chromium, WebGL in software:
// a lower bound for any machine with a graphics card. The host simulates the gallery with edges of EDGE_M metres, at
// most 12 steps a second, so that it does not take all of the processors itself.
//
// The browser gives way to the session, as one does that has a graphics card or processors of its own. PRIORITIES="A B"
// are the priorities of the session's processes and of the browser (`prioritise`), 0 and 19 without it; higher ones,
// which need the right to them, leave other programs of a busy machine aside. With DRAWN=no frames are fetched as by a
// page, 10 a second, and nothing is drawn: what the session has of a viewer whose drawing a graphics card does.
import { createInterface } from "node:readline";
import { launch } from "./browser.mjs";
import { below, megabytes, prioritise, processorSeconds, processSeconds } from "./processors.mjs";
import { Processes } from "./processes.mjs";

const [untangled, edge = "0.0114", seconds = "5", runs = "8"] = process.argv.slice(2);
const [ofSession, ofBrowser] = (process.env.PRIORITIES ?? "0 19").split(" ");
const processes = new Processes(untangled, `rate-${process.pid}`);
let trips = [];

await processes.serve();
const args = ["--scene", "gallery", "--edge-m", edge, "--no-corrections", "--substeps", "1", "--rate", "12"];
const more = ["--frames", "1000000", "--clean-frames", "0", "--report-every", "1"];
const host = processes.start(["publish", ...args, ...more], ["ignore", "pipe", "inherit"]);
processes.hosts.push(host);
const said = createInterface({ input: host.stdout });
said.on("line", (text) => {
  const ms = /round trip +([\d.]+) ms/.exec(text)?.[1];
  if (ms) trips.push(Number(ms));
  else console.log(text);
});
await new Promise((done, failed) => {
  said.once("line", done);
  said.once("close", () => failed(new Error("the host has ended")));
}).catch(async (error) => {
  await processes.end();
  throw error;
});
const address = await processes.watch();
const { browser, tab } = await launch(address, { width: 1280, height: 900 });
const ofTheSession = [processes.daemon, host, processes.page].map(({ pid }) => pid);
await prioritiseAll();
const middle = (values) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];
const [withPage, without] = [[], []];
let [isFetching, numFetched] = [false, 0];
try {
  for (let run = 0; run <= Number(runs); run++) {
    await tab.goto("about:blank");
    without.push(await phase());
    if (run === Number(runs)) break;
    if (process.env.DRAWN === "no") {
      isFetching = true;
      const end = fetchAll();
      withPage.push(await phase());
      isFetching = false;
      await end;
    } else {
      await tab.goto(address);
      await tab.waitForSelector("html[data-ready]");
      // A process of the browser may be a new one.
      await prioritiseAll();
      withPage.push(await phase());
    }
  }
} finally {
  await browser.close();
  await processes.end();
}
// The simulation changes, and round trips with it: a run with the page is compared with those before and after it.
const beside = (run) => (without[run].trip + without[run + 1].trip) / 2;
const ratios = withPage.map((own, run) => own.trip / beside(run)).toSorted((a, b) => a - b);
const [low, high] = [ratios[Math.floor(ratios.length / 5)], ratios[ratios.length - 1 - Math.floor(ratios.length / 5)]];
const of = (rows, name) => middle(rows.map((row) => row[name]));
console.log(
  `page ${of(withPage, "page").toFixed(1)} frames a second, session ${of(withPage, "session").toFixed(1)}; ` +
    `round trip ${of(without, "trip").toFixed(2)} ms without the page, ` +
    `${of(withPage, "trip").toFixed(2)} ms with it, ` +
    `ratio ${middle(ratios).toFixed(3)}, of most runs ${low.toFixed(3)} to ${high.toFixed(3)}; ` +
    `processors for a frame: browser ${of(withPage, "browser").toFixed(0)} ms, ` +
    `untangled watch ${of(withPage, "server").toFixed(1)} ms, ` +
    `daemon ${of(without, "daemon").toFixed(1)} ms without the page ` +
    `and ${of(withPage, "daemon").toFixed(1)} ms with it; ` +
    `memory of untangled watch ${of(withPage, "memory").toFixed(0)} MB`,
);

async function prioritiseAll() {
  // This program fetches in place of a browser.
  for (const pid of [process.pid, ...below(process.pid)])
    await prioritise(pid, ofTheSession.includes(pid) ? ofSession : ofBrowser);
}

/** What was measured for some seconds. */
async function phase() {
  const before = await look();
  trips = [];
  await new Promise((done) => setTimeout(done, 1000 * Number(seconds)));
  const own = trips;
  const after = await look();
  const passed = after.at - before.at;
  const frames = after.frames - before.frames;
  const each = (name, count) => (1000 * (after[name] - before[name])) / Math.max(1, count);
  const row = {
    page: frames / passed,
    session: own.length / passed,
    trip: middle(own),
    ...(frames > 0 ? { browser: each("browser", frames), server: each("server", frames) } : {}),
    daemon: each("daemon", own.length),
    memory: megabytes(processes.page.pid),
  };
  console.log(
    Object.entries(row)
      .map(([name, value]) => `${name} ${value.toFixed(2)}`)
      .join(", "),
  );
  return row;
}

async function look() {
  const own = [processes.daemon, processes.page, host].map(({ pid }) => processSeconds(pid));
  return {
    frames: numFetched + (await tab.evaluate(() => Number(document.documentElement.dataset.frames ?? 0))),
    at: performance.now() / 1000,
    browser: own.reduce((left, seconds) => left - seconds, processorSeconds()),
    server: own[1],
    daemon: own[0],
  };
}

/** Asks for frames as a page does that draws each in a tenth of a second. */
async function fetchAll() {
  const [{ session }] = (await (await fetch(`${address}sessions`)).json()).sessions;
  for (let serial = "0"; isFetching;) {
    const answer = await fetch(`${address}frame?session=${session}&after=${serial}`);
    serial = answer.headers.get("Untangled-Serial") ?? serial;
    if ((await answer.arrayBuffer()).byteLength > 0) numFetched += 1;
    await new Promise((done) => setTimeout(done, 100));
  }
}
