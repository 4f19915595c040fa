import type { Camera } from '../camera.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { SplatCloud } from './splat-cloud.ts';

/** A cloud and where it stands. */
export interface CloudInstance {
  readonly cloud: SplatCloud;
  /** Scene to world, 16 numbers, column-major, read in float64; default the identity. */
  readonly modelMatrix?: ArrayLike<number>;
  /** Multiplies every splat's opacity, 0…1; default 1. At 0 nothing of the cloud is drawn. */
  readonly opacity?: number;
}

/** One picture. */
export interface ViewFrame {
  readonly camera: Camera;
  /** In the order in which equal depths are drawn. */
  readonly clouds: readonly CloudInstance[];
  /** Size in physical pixels, whole numbers; nothing is drawn where one is 0. */
  readonly widthPx: number;
  readonly heightPx: number;
  /** What is behind the splats on a canvas, sRGB-encoded, 0…1; default black. */
  readonly background?: Vec3;
  /** Draw even where nothing has changed, as a benchmark needs it. */
  readonly force?: boolean;
}
