import type { ScenePlace } from '@websplatter/core/effect-options';
import { flippedPoint } from '../camera/flip.ts';
import { boundsOf } from '../camera/scene-bounds.ts';
import { scenePlaceOf } from '../engine/scene-place.ts';
import type { Crop } from '../state/inspecting.ts';
import { add, clamp, scale, type Vec3, withAxis } from '../state/vec3.ts';
import { drawCrop } from './draw-crop.ts';
import type { EditHistory } from './edit-history.ts';
import { type InspectTools, shownLook } from './inspect-tools.ts';

type Box = Pick<Crop, 'min' | 'max'>;

/** `box` with another least or greatest value along an axis; the other end gives way. */
export function withSide<Boxed extends Box>(
  box: Boxed,
  side: 'min' | 'max',
  axis: number,
  value: number,
): Boxed {
  const [other, limit] = side === 'min' ? (['max', Math.max] as const) : (['min', Math.min] as const);
  return {
    ...box,
    [side]: withAxis(box[side], axis, value),
    [other]: withAxis(box[other], axis, limit(box[other][axis], value)),
  };
}

/** The middle of the face where `box` ends along an axis. */
export function faceMiddle({ min, max }: Box, side: 'min' | 'max', axis: number): Vec3 {
  return withAxis(scale(add(min, max), 0.5), axis, { min, max }[side][axis]);
}

/** Positions of a slider run from 0 to this. */
export const SLIDER_STEPS = 400;

interface SliderRange {
  readonly low: number;
  readonly high: number;
  /** Between them; steps are finest around it. */
  readonly middle: number;
}

/** The value at a slider's `position`: the cube of the way from the slider's middle to its end. */
export function sliderValue(position: number, { low, high, middle }: SliderRange): number {
  const way = (2 * position) / SLIDER_STEPS - 1;
  return middle + (way < 0 ? middle - low : high - middle) * way ** 3;
}

/** The slider's position for `value`. */
export function sliderPosition(value: number, { low, high, middle }: SliderRange): number {
  const side = value < middle ? middle - low : high - middle;
  const way = side > 0 ? Math.cbrt((value - middle) / side) : 0;
  return Math.round((SLIDER_STEPS * (1 + way)) / 2);
}

/** Crops the scene to a box, in the image at once and when it is saved. */
export class Cropping {
  readonly #tools: InspectTools;
  readonly #history: EditHistory;
  #isCounting = false;

  constructor(tools: InspectTools, history: EditHistory) {
    this.#tools = tools;
    this.#history = history;
  }

  /** The box around the scene without stray splats, in its own space; null without a scene. */
  get sceneBox(): Box | null {
    const scene = this.#tools.viewer.scenes.newest;
    return scene && boundsOf(scene.clouds, 'robustBounds');
  }

  /** The sphere that the scene's first view frames, in the scene's own space. */
  get place(): Pick<ScenePlace, 'center' | 'radius'> {
    const { store, viewer } = this.#tools;
    const { center, radius } = scenePlaceOf(viewer);
    return { center: store.getState().isFlipped ? flippedPoint(center) : center, radius };
  }

  /**
   * Crops to `crop` from the next frame on, or with null not at all.
   *
   * @param gesture successive crops of one gesture are undone together.
   */
  set(crop: Crop | null, gesture: unknown = null): void {
    this.#history.edit('Crop', { crop }, gesture);
    this.count();
  }

  /**
   * Begins with the scene's box, clipped to the cube around the sphere that its first view frames:
   * faces of a box with the camera inside it are far from view.
   */
  begin(): void {
    const { sceneBox, place } = this;
    if (!sceneBox) return;
    const side = (way: 1 | -1) =>
      place.center.map((value, axis) =>
        clamp(value + way * place.radius, sceneBox.min[axis], sceneBox.max[axis]),
      ) as unknown as Vec3;
    this.set({ min: side(-1), max: side(1), keep: 'inside' });
  }

  /** Crops to a box around nearly all splats. */
  cropToScene(): void {
    const { sceneBox } = this;
    if (sceneBox) this.set({ ...sceneBox, keep: 'inside' });
  }

  /** Draws the cropped scene, the way up that the scene is shown. */
  draw(): void {
    drawCrop(this.#tools);
  }

  /** Counts the splats that stay, unless the number is known already. */
  count(): void {
    const { crop, cropCount } = this.#tools.store.getState().inspecting;
    if (crop && !cropCount) void this.#count();
  }

  /** Crops to the smallest box that has all splats whose centres are within the image. */
  async cropToView(): Promise<void> {
    const { reader, update } = this.#tools;
    const look = shownLook(this.#tools);
    if (!look) return;
    const bounds = await reader.ask('seen', look);
    if (bounds === null) update({ problem: 'No splat is within the picture.' });
    if (bounds) this.set({ min: bounds.min, max: bounds.max, keep: 'inside' });
  }

  /** Counts the splats that stay; during a drag, only of the newest box after each count. */
  async #count(): Promise<void> {
    if (this.#isCounting) return;
    const { store, reader, update } = this.#tools;
    const { crop } = store.getState().inspecting;
    if (!crop) return;
    this.#isCounting = true;
    const cropCount = await reader.ask('count', crop);
    this.#isCounting = false;
    const now = store.getState().inspecting.crop;
    if (now === crop && cropCount) update({ cropCount });
    else if (now !== crop && cropCount) void this.#count();
  }
}
