// The processes of a live session, for drive/watch.mjs and drive/rate.mjs: a daemon, hosts, and untangled watch.
import { spawn } from "node:child_process";
import { createInterface } from "node:readline";

export class Processes {
  hosts = [];
  daemon = null;
  page = null;

  constructor(untangled, domain) {
    this.untangled = untangled;
    this.domain = domain;
  }

  start(args, stdio) {
    return spawn(this.untangled, [args[0], "--domain", this.domain, ...args.slice(1)], { stdio });
  }

  /** Those that have ended without being told to, in words. */
  gone() {
    const named = [
      ["untangled watch", this.page],
      ["the daemon", this.daemon],
      ...this.hosts.map((host) => ["a host", host]),
    ];
    const isGone = ([, one]) => one && (one.exitCode !== null || one.signalCode !== null);
    return named.filter(isGone).map(([name, one]) => `${name} has ended: ${one.exitCode ?? one.signalCode}`);
  }

  /** The address of the page. */
  async watch() {
    this.page = this.start(["watch"], ["ignore", "pipe", "inherit"]);
    return line(this.page.stdout, /^http/);
  }

  /** A daemon that is ready. */
  async serve() {
    this.daemon = this.start(["serve"], ["ignore", "ignore", "pipe"]);
    await line(this.daemon.stderr, /^ready$/);
  }

  async endDaemon() {
    await ended(this.daemon);
    this.daemon = null;
  }

  /** A host that plays a scene without applying corrections, so that it stays tangled. */
  publish(scene, more = []) {
    const args = ["publish", "--scene", scene, "--no-corrections", "--frames", "1000000", "--clean-frames", "0"];
    const host = this.start([...args, "--report-every", "0", "--connect-timeout-ms", "3600000", ...more], "ignore");
    this.hosts.push(host);
    return host;
  }

  async end() {
    for (const host of [...this.hosts, this.page, this.daemon]) if (host) await ended(host);
  }
}

/** The first line that is so; what comes after it is read, so that nobody waits to write. */
function line(stream, pattern) {
  return new Promise((done, failed) => {
    const lines = createInterface({ input: stream });
    lines.on("line", (text) => pattern.test(text) && done(text.trim()));
    lines.on("close", () => failed(new Error(`it ended before it said ${pattern}`)));
  });
}

/** Ends a process as Ctrl-C does. */
async function ended(process) {
  if (process.exitCode !== null || process.signalCode !== null) return;
  const end = new Promise((done) => process.once("exit", done));
  process.kill("SIGINT");
  await end;
}
