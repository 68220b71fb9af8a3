// Processor time, which does not depend on what else the machine does; memory; and priorities.
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { setPriority } from "node:os";

/** Processor time of all processes in seconds, and their parents; nothing where there is no /proc. */
function processes() {
  const all = new Map();
  let ids = [];
  try {
    ids = readdirSync("/proc").filter((name) => /^\d+$/.test(name));
  } catch {
    return all;
  }
  for (const id of ids) {
    try {
      const fields = readFileSync(`/proc/${id}/stat`, "utf8").split(") ")[1].split(" ");
      all.set(Number(id), { parent: Number(fields[1]), seconds: (Number(fields[11]) + Number(fields[12])) / 100 });
    } catch {
      // It has ended.
    }
  }
  return all;
}

/** All processes below a process. */
export function below(root, all = processes()) {
  return [...all.keys()].filter((id) => {
    let at = all.get(id)?.parent;
    while (at && at !== root) at = all.get(at)?.parent;
    return Boolean(at);
  });
}

/** Seconds that all processes below a process have taken; nothing where there is no /proc. */
export function processorSeconds(root = process.pid) {
  const all = processes();
  if (all.size === 0) return NaN;
  return below(root, all).reduce((sum, id) => sum + all.get(id).seconds, 0);
}

/**
 * Sets the priority of a process: `rt4` is a real-time one of 4 (`chrt --rr`), above all that have none; else that of
 * `nice`, of its threads and of its group where Linux shares processors among groups (`sched_autogroup_enabled`), in
 * which those of threads say nothing to other groups.
 */
export async function prioritise(id, priority) {
  const realTime = /^rt(\d+)$/.exec(priority)?.[1];
  if (realTime) {
    execFileSync("chrt", ["--rr", "--all-tasks", "--pid", realTime, String(id)]);
    return;
  }
  const nice = Number(priority);
  for (const thread of readdirSync(`/proc/${id}/task`)) setPriority(Number(thread), nice);
  const group = `/proc/${id}/autogroup`;
  if (!existsSync(group) || readFileSync(group, "utf8").trim().endsWith(` nice ${nice}`)) return;
  writeFileSync(group, String(nice));
  // Linux takes ten of these a second from those who may not do all.
  await new Promise((done) => setTimeout(done, 200));
}

/** Seconds that one process has taken. */
export function processSeconds(id) {
  const fields = readFileSync(`/proc/${id}/stat`, "utf8").split(") ")[1].split(" ");
  return (Number(fields[11]) + Number(fields[12])) / 100;
}

/** Memory of a process that is in use, in MB. */
export function megabytes(id) {
  return Number(/VmRSS:\s+(\d+) kB/.exec(readFileSync(`/proc/${id}/status`, "utf8"))[1]) / 1e3;
}
