// The page of untangled watch: puts its parts together.
import { themeChoice } from "../controls";
import { counted, el } from "../dom";
import { Legend, PathList, numbers } from "./details";
import { Feed, type SessionLine, type Sessions } from "./feed";
import { History } from "./history";
import type { FrameMessage, MeshMessage } from "./message";
import { Picture } from "./picture";
import { Plots } from "./plots";
import { Timeline } from "./timeline";

/** Words and lists follow so many times a second: people read no faster. */
const WORDS_MS = 500;
const LIST_MS = 1000;

const KEYS =
  "With the picture focused: space pauses and goes on, comma and full stop step to the frame before and after, " +
  "arrow keys turn the picture, with Shift they move it, + and − bring it nearer and farther, Home shows all of it, " +
  "N and P go to the next and the previous path. A pointer turns it, with Shift or the right button moves it; the " +
  "wheel zooms once the picture has the focus.";

class Page {
  private readonly history = new History();
  private readonly timeline = new Timeline(this.history, (at) => this.moved(at));
  private readonly plots = new Plots((at) => this.seek(at));
  private readonly legend = new Legend(() => this.picture?.view ?? null);
  private readonly list = new PathList((path) => this.pick(path, true));
  private readonly feed: Feed;
  private readonly sessions = el("select", { id: "session", change: () => this.choose() });
  private readonly verdict = el("p", { class: "verdict" }, "Looking for sessions");
  private readonly status = el("p", { class: "status", role: "status", "aria-live": "polite" });
  private readonly place = el("div", { class: "place" });
  private readonly controls = el("div", {});
  private readonly chosen = el("div", {});
  private readonly numbers = el("div", { class: "tables" });
  private readonly footer = el("footer", {});
  private mesh: MeshMessage | null = null;
  private picture: Picture | null = null;
  private picked: number | null = null;
  private shownAt: number[] = [];
  private wordsAt = 0;
  private listAt = 0;

  constructor(root: HTMLElement) {
    root.append(
      el(
        "header",
        {},
        el("h1", {}, "untangled watch"),
        el("label", { class: "plain", for: "session" }, "Session ", this.sessions),
        themeChoice(),
      ),
      this.verdict,
      el(
        "main",
        {},
        el(
          "div",
          { class: "main" },
          el(
            "div",
            { class: "picture" },
            this.place,
            this.status,
            this.timeline.element,
            this.controls,
            this.legend.element,
            el("p", { id: "keys", class: "hint" }, KEYS),
          ),
          el("div", { class: "side" }, this.chosen, this.list.element, this.plots.element),
        ),
        this.numbers,
      ),
      this.footer,
    );
    this.feed = new Feed({
      sessions: (sessions, chosen) => this.showSessions(sessions, chosen),
      mesh: (mesh, line) => this.setMesh(mesh, line),
      frame: (frame) => this.setFrame(frame),
      lost: (words) => this.lose(words),
    });
  }

  private showSessions({ version, daemon, sessions }: Sessions, chosen: string | null) {
    this.footer.textContent = `untangled ${version}, domain ${daemon}. This page sends nothing to anybody else.`;
    const words = (line: SessionLine) => `${line.host}: ${counted(line.num_faces, "triangle")}`;
    const wanted = sessions.map((line) => `${line.session} ${words(line)}`).join("\n");
    if (this.sessions.dataset["shown"] !== wanted) {
      this.sessions.dataset["shown"] = wanted;
      this.sessions.replaceChildren(
        ...sessions.map((line) => el("option", { value: line.session }, words(line))),
        ...(sessions.length === 0 ? [el("option", { value: "" }, "none yet")] : []),
      );
    }
    this.sessions.value = sessions.some(({ session }) => session === chosen) ? chosen! : "";
    if (sessions.length === 0 && this.mesh === null) this.say("No session yet: waiting for a host to register one");
  }

  private choose() {
    if (this.timeline.isPaused) this.timeline.resume();
    this.feed.choose(this.sessions.value);
  }

  private setMesh(mesh: MeshMessage, line: SessionLine) {
    this.mesh = mesh;
    this.picture?.dispose();
    this.picture = null;
    this.picked = null;
    this.history.clear();
    this.plots.clear();
    this.say(`Watching ${line.host}`);
  }

  private async setFrame(frame: FrameMessage) {
    const start = performance.now();
    this.history.add(frame);
    this.plots.add(frame);
    await this.show(frame, true);
    const took = performance.now() - start;
    this.picture?.adapt(took, !this.timeline.isPaused);
    this.shownAt = [...this.shownAt.filter((at) => start - at < 2000), start];
    const { dataset } = document.documentElement;
    dataset["ready"] = "yes";
    dataset["frames"] = String(Number(dataset["frames"] ?? 0) + 1);
    const rest = Math.max(this.timeline.leastMs, this.picture?.leastMs ?? 0) - took;
    if (rest > 0) await new Promise((done) => setTimeout(done, rest));
  }

  private async show(frame: FrameMessage, isLive: boolean) {
    if (!this.picture) this.open(frame);
    const now = performance.now();
    const isSaid = !isLive || now - this.wordsAt > WORDS_MS;
    if (isSaid) {
      this.wordsAt = now;
      this.showWords(frame);
    }
    if (!isLive || (now - this.listAt > LIST_MS && !this.list.isInUse)) {
      this.listAt = now;
      this.list.show(frame, this.picked);
      this.chosen.replaceChildren(this.list.details() ?? "");
    }
    document.documentElement.dataset["frame"] = String(frame.frame);
    await this.picture?.show(frame, this.picked, isLive, isSaid);
  }

  private open(frame: FrameMessage) {
    try {
      this.picture = new Picture(this.mesh!, frame, {
        pick: (path) => this.pick(path, false),
        beside: (step) => this.beside(step),
        pause: () => this.timeline.toggle(),
        step: (by) => this.timeline.step(by),
      });
      this.place.replaceChildren(this.picture.element);
      this.controls.replaceChildren(this.picture.controls);
    } catch (error) {
      const words = error instanceof Error ? error.message : String(error);
      this.place.replaceChildren(el("p", { class: "verdict tangled" }, `This browser shows no picture (${words}).`));
    }
  }

  private showWords(frame: FrameMessage) {
    const pairs = frame.counts["num_face_pairs"] ?? 0;
    const onWrongSide = (frame.wrong ?? []).reduce((sum, { num_vertices }) => sum + num_vertices, 0);
    const isClean = pairs === 0 && onWrongSide === 0 && !frame.refused;
    const rate = (this.shownAt.length / 2).toFixed(0);
    const crossing = pairs === 0 ? "nothing intersects" : `${counted(pairs, "face pair")} intersect`;
    const wrong = `, ${counted(onWrongSide, "vertex", "vertices")} on the wrong side of a body or a layer`;
    const found = frame.refused ?? `${crossing}${onWrongSide > 0 ? wrong : ""}`;
    const live = this.timeline.isPaused ? "paused" : `${rate} frames a second`;
    this.verdict.className = `verdict ${isClean ? "clean" : "tangled"}`;
    this.verdict.textContent = `${isClean ? "✓" : "✗"} ${found}; ${live}`;
    this.legend.show(frame);
    this.timeline.say();
    this.numbers.replaceChildren(numbers(frame));
  }

  /** To a frame of the history, or to the newest. */
  private moved(at: number | null) {
    const frame = at === null ? null : this.history.at(at);
    this.feed.setPaused(at !== null);
    this.plots.mark(frame ?? null);
    this.picked = null;
    this.say(at === null ? "Live" : "Paused");
    if (!frame) return;
    this.picture?.adapt(0, false);
    void this.show(frame, false);
  }

  private seek(at: number) {
    for (let index = this.history.length - 1; index >= 0; index--) {
      if (index === 0 || this.history.at(index)!.at <= at) return this.timeline.pause(index);
    }
  }

  private beside(step: number) {
    const path = this.list.beside(step);
    if (path !== null) this.pick(path, true);
  }

  /** Chooses a path, of the frame that the list has; the picture stands still then. */
  private pick(path: number | null, isSought: boolean) {
    const shown = this.list.frame;
    if (path === null) {
      this.picked = null;
      this.picture?.view.pickPath(0, null, false);
      this.showChosen();
      return;
    }
    if (!this.timeline.isPaused) {
      const index = isSought ? this.history.indexOf(shown) : this.history.length - 1;
      this.timeline.pause(index);
    }
    this.picked = path;
    this.picture?.view.pickPath(0, path, isSought);
    this.showChosen();
  }

  private showChosen() {
    this.list.mark(this.picked);
    const details = this.list.details();
    this.chosen.replaceChildren(details ?? "");
    if (details) this.say(this.list.words());
  }

  private lose(words: string) {
    this.mesh = null;
    this.verdict.className = "verdict";
    this.verdict.textContent = "No frames come";
    this.say(words);
    document.documentElement.dataset["lost"] = String(Number(document.documentElement.dataset["lost"] ?? 0) + 1);
  }

  private say(words: string) {
    if (this.status.textContent !== words) this.status.textContent = words;
  }
}

new Page(document.getElementById("page")!);
