// Asks untangled watch: for the sessions once a second, and for the newest frame whenever the last one is drawn, so
// that a slow page loses frames and is never late.
import { type FrameMessage, type MeshMessage, readFrame, readMesh } from "./message";

export interface SessionLine {
  session: string;
  host: string;
  num_vertices: number;
  num_faces: number;
  num_frames: number;
}

export interface Sessions {
  version: string;
  daemon: string;
  /** Why there are none, in words. */
  waiting: string | null;
  sessions: SessionLine[];
}

export interface Listener {
  sessions: (sessions: Sessions, chosen: string | null) => void;
  mesh: (mesh: MeshMessage, session: SessionLine) => void;
  /** Resolves when the frame is drawn. */
  frame: (frame: FrameMessage) => Promise<void>;
  /** There is nothing to show any more. */
  lost: (words: string) => void;
}

const SESSIONS_EVERY_MS = 1000;
const AGAIN_AFTER_MS = 300;

const sleep = (ms: number) => new Promise((done) => setTimeout(done, ms));

export class Feed {
  private lines: SessionLine[] = [];
  private chosen: string | null = null;
  private open: string | null = null;
  private serial = "0";
  private isPaused = false;
  private wake = () => {};

  constructor(private readonly listener: Listener) {
    document.addEventListener("visibilitychange", () => this.wake());
    void this.followSessions();
    void this.followFrames();
  }

  /** A session by its name. */
  choose(session: string) {
    this.chosen = session;
    this.wake();
  }

  /** A page that is paused asks for nothing. */
  setPaused(isPaused: boolean) {
    this.isPaused = isPaused;
    this.wake();
  }

  private async followSessions() {
    for (;;) {
      if (!document.hidden) await this.askSessions();
      await sleep(SESSIONS_EVERY_MS);
    }
  }

  private async askSessions() {
    try {
      const answer = await fetch("sessions");
      if (!answer.ok) throw new Error(await answer.text());
      const sessions = (await answer.json()) as Sessions;
      this.lines = sessions.sessions;
      // One that has ended makes room for the first that is there; without an answer it may be there still.
      const isThere = this.lines.some(({ session }) => session === this.chosen);
      if (!isThere && this.lines.length > 0) this.chosen = this.lines[0]!.session;
      this.listener.sessions(sessions, this.chosen);
      if (sessions.waiting !== null && this.open === null) this.listener.lost(sessions.waiting);
    } catch {
      this.lines = [];
      this.lose("untangled watch does not answer: it was ended, or runs at another address now");
    }
  }

  private async followFrames() {
    for (;;) {
      if (this.isPaused || document.hidden) {
        await new Promise<void>((done) => (this.wake = done));
        continue;
      }
      const line = this.lines.find(({ session }) => session === this.chosen);
      if (!line) await sleep(AGAIN_AFTER_MS);
      else if (!(await this.step(line))) await sleep(AGAIN_AFTER_MS);
    }
  }

  /** Asks for a mesh that is not there yet, else for a frame. Whether to go on at once. */
  private async step(line: SessionLine): Promise<boolean> {
    const session = line.session;
    try {
      if (this.open !== session) {
        const mesh = await this.ask(`mesh?session=${session}`);
        if (mesh === null) return false;
        this.listener.mesh(readMesh(mesh), line);
        this.open = session;
      }
      const buffer = await this.ask(`frame?session=${session}&after=${this.serial}`);
      if (buffer === null || this.isPaused || session !== this.chosen) return true;
      await this.listener.frame(readFrame(buffer, performance.now()));
      return true;
    } catch (error) {
      this.lose(error instanceof Error ? error.message : String(error));
      return false;
    }
  }

  /** The bytes of an answer; nothing where there is nothing new. */
  private async ask(what: string): Promise<ArrayBuffer | null> {
    const answer = await fetch(what).catch(() => null);
    if (!answer) throw new Error("untangled watch does not answer");
    if (!answer.ok) throw new Error((await answer.text()).trim());
    this.serial = answer.headers.get("Untangled-Serial") ?? this.serial;
    const buffer = await answer.arrayBuffer();
    return buffer.byteLength > 0 ? buffer : null;
  }

  private lose(words: string) {
    this.open = null;
    this.listener.lost(words);
  }
}
