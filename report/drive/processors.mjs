// Processor time, which does not depend on what else the machine does.
import { readFileSync, readdirSync } from "node:fs";

/** Seconds that all processes below a process have taken; nothing where there is no /proc. */
export function processorSeconds(root = process.pid) {
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
    while (at && at !== String(root)) at = parents.get(at);
    if (at) sum += own.get(id);
  }
  return sum;
}

/** Seconds that one process has taken. */
export function processSeconds(id) {
  const fields = readFileSync(`/proc/${id}/stat`, "utf8").split(") ")[1].split(" ");
  return (Number(fields[11]) + Number(fields[12])) / 100;
}
