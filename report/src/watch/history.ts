// The frames of the last seconds, to step back over.
import type { FrameMessage } from "./message";

const MOST_SECONDS = 20;
const MOST_BYTES = 192e6;

export class History {
  private frames: FrameMessage[] = [];
  private numBytes = 0;

  get length(): number {
    return this.frames.length;
  }

  at(index: number): FrameMessage | undefined {
    return this.frames[index];
  }

  /** Where a frame stands; the newest one if it is gone. */
  indexOf(frame: FrameMessage | null): number {
    const index = frame ? this.frames.indexOf(frame) : -1;
    return index < 0 ? this.frames.length - 1 : index;
  }

  /** Adds the newest; the oldest make room. */
  add(frame: FrameMessage) {
    this.frames.push(frame);
    this.numBytes += frame.numBytes;
    const isTooMuch = (oldest: FrameMessage) =>
      this.numBytes > MOST_BYTES || frame.at - oldest.at > 1000 * MOST_SECONDS;
    let num = 0;
    while (num + 1 < this.frames.length && isTooMuch(this.frames[num]!)) this.numBytes -= this.frames[num++]!.numBytes;
    this.frames.splice(0, num);
  }

  clear() {
    this.frames = [];
    this.numBytes = 0;
  }
}
