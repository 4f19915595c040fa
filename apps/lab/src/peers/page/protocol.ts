import type { SceneCamera } from '@websplatter/scenes';
import type { PeerFormats } from '../adapter.ts';
import type { Wait } from './completion.ts';
import type { MeasuredFrames } from './frame-times.ts';

/** Calls of the runner, on `window.bench`. The page times everything, undisturbed by messages. */
export interface BenchPage {
  /** Formats that the peer reads. */
  formats(): PeerFormats;
  load(request: LoadRequest): Promise<Loaded>;
  /** Loads a scene that streams, until it is at rest. */
  /** Streams a scene until it is at rest. */
  stream(request: LoadRequest): Promise<Streamed>;
  /** As `stream`, and looks at every frame up to the first that shows anything, which takes the thread's time. */
  streamWatched(request: LoadRequest): Promise<Watched>;
  measure(request: MeasureRequest): Promise<Measured>;
  /** The picture by each camera; of a scene that streams, at rest. */
  pictures(cameras: readonly SceneCamera[]): Promise<Picture[]>;
  state(): PageState;
}

export interface LoadRequest {
  /** Null for the file that the page was given. */
  readonly url: string | null;
  /** Without folders. */
  readonly fileName: string;
  readonly widthPx: number;
  readonly heightPx: number;
  readonly wait: Wait;
  readonly camera: SceneCamera;
}

export interface Loaded {
  /** From the call of the adapter to the end of the first frame in the right order. */
  readonly loadMs: number;
  /** To the end of the first frame with any splats: `loadMs`, unless a part is shown before. */
  readonly firstSplatsMs: number;
  /** Longest time that the page's thread was blocked; 0 below the 50 ms that browsers report. */
  readonly longestTaskMs: number;
  readonly api: 'webgpu' | 'webgl2';
  readonly note: string;
}

/** How a scene that streams appeared. Frames are drawn all the time, as many as 60 a second. */
export interface Streamed {
  /** The call of the adapter, from which the times count; ms since 1970, as the runner counts. */
  readonly startedAtMs: number;
  /** To the end of the first complete frame after which all frames up to rest are complete. */
  readonly completeMs: number;
  /** As of {@link Loaded}. */
  readonly longestTaskMs: number;
  readonly api: 'webgpu' | 'webgl2';
  readonly note: string;
}

/** How soon a scene is seen. */
export interface Watched extends Pick<Streamed, 'startedAtMs'> {
  /** To the end of the first frame that leaves a pixel other than black. */
  readonly firstPictureMs: number;
  /** How near that was to the complete picture, both made smaller; dB, Infinity (JSON: null) if alike. */
  readonly firstPsnrDb: number;
}

export interface MeasureRequest {
  /** Turned about its target. */
  readonly camera: SceneCamera;
  /** Frames of one turn. */
  readonly frames: number;
  /** Frames before anything is measured. */
  readonly warmUpFrames: number;
  /** Frames that are each seen from far away from the one before. */
  readonly jumps: number;
  /** Whether the GPU's time is measured by frame and pass, too. Default: false. */
  readonly isByPass?: boolean;
}

/** Times are from the change of the camera to the end of the GPU's work, one per frame. */
export interface Measured {
  /** Frames of a steady turn, in the newest order if orders are made outside of the frame. */
  readonly turnMs: readonly number[];
  /** How many orders were made in the turn; null where every frame makes its own. */
  readonly orders: number | null;
  /** Frames after jumps, in the right order. */
  readonly correctMs: readonly number[];
  /** GPU time of frames of a further turn, by timestamps; empty without WebGPU's. */
  readonly gpuMs: readonly number[];
  /** Of a further turn; null unless asked for, and without WebGPU's timestamps. */
  readonly byPass: MeasuredFrames | null;
}

export interface Picture {
  readonly camera: string;
  readonly widthPx: number;
  readonly heightPx: number;
  /** RGBA over black, 8 bits each, top row first. */
  readonly rgbaBase64: string;
  /** As the canvas has it. */
  readonly pngBase64: string;
}

export interface PageState {
  readonly gpuBytes: number;
  readonly gpuPeakBytes: number;
  /** WebGPU's adapter or WebGL's renderer, in words. */
  readonly adapter: string | null;
  readonly figures: Readonly<Record<string, unknown>>;
  readonly problems: readonly string[];
}
