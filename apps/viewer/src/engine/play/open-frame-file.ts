import type { CloudInstance, SplatCloud, SplatEngine } from '@websplatter/core';
import { type OpenFramesOptions, openFrames, type SplatFrames } from '@websplatter/core/frames';
import { type LastingScene, lastingScene } from '../open/lasting-scene.ts';
import type { ShownPart } from '../open/shown-scene.ts';
import { framesOf } from './scene-time.ts';

/** Part of a frame by which a time may fall short of the frame's beginning: rounding of seconds. */
const TOLERANCE = 1e-6;

/** Opens a scene's file of frames. Rejects as `openFrames`. */
export function openFrameFile(source: LastingScene, options: OpenFramesOptions = {}): Promise<SplatFrames> {
  if (source.kind === 'url') return openFrames(new URL(source.href), options);
  return openFrames(source.source, { maxSplats: Number.POSITIVE_INFINITY, ...options, name: source.name });
}

/** Index of the frame at a time; the last one from the end on. */
export function frameAt(timeS: number, frameCount: number, framesPerS: number): number {
  return Math.max(0, Math.min(frameCount - 1, Math.floor(timeS * framesPerS + TOLERANCE)));
}

interface FilmedFile {
  readonly file: SplatFrames;
  frame: number;
  cloud: SplatCloud | null;
}

/** Loads the frames that a video shows, one time after another. The frames on the screen stay. */
export class FilmedFrames {
  readonly #engine: SplatEngine;
  readonly #files: ReadonlyMap<SplatCloud, FilmedFile>;

  private constructor(engine: SplatEngine, files: ReadonlyMap<SplatCloud, FilmedFile>) {
    this.#engine = engine;
    this.#files = files;
  }

  /** Rejects as `openFrames`. */
  static async open(engine: SplatEngine, parts: readonly ShownPart[]): Promise<FilmedFrames> {
    const files = new Map<SplatCloud, FilmedFile>();
    for (const part of parts) {
      const shown = part.loaded.clouds.find(({ cloud }) => framesOf(cloud));
      const source = shown && lastingScene(part);
      if (source) files.set(shown.cloud, { file: await openFrameFile(source), frame: -1, cloud: null });
    }
    return new FilmedFrames(engine, files);
  }

  /**
   * Returns clouds on the screen as they are at a time. The frames of the time before are destroyed: they must
   * have been drawn.
   *
   * Rejects as `SplatEngine.load`.
   */
  async at(clouds: readonly CloudInstance[], timeS: number): Promise<CloudInstance[]> {
    const shown: CloudInstance[] = [];
    for (const instance of clouds) {
      const filmed = this.#files.get(instance.cloud);
      if (!filmed) {
        shown.push(instance);
        continue;
      }
      const { frames, framesPerS } = filmed.file;
      const frame = frameAt(timeS, frames.length, framesPerS);
      if (frame !== filmed.frame) {
        const before = filmed.cloud;
        filmed.cloud = await this.#engine.load(frames[frame], { fit: 'auto' });
        filmed.frame = frame;
        before?.destroy();
      }
      shown.push({ ...instance, cloud: filmed.cloud! });
    }
    return shown;
  }

  end(): void {
    for (const { file, cloud } of this.#files.values()) {
      cloud?.destroy();
      file.end();
    }
  }
}
