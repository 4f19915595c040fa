import type { ScenePlace } from '@websplatter/core/effect-options';
import { flippedPoint } from '../camera/flip.ts';
import { boundsOf } from '../camera/scene-bounds.ts';
import { cloudKeys } from '../engine/open/shown-scene.ts';
import { scenePlaceOf } from '../engine/show/scene-place.ts';
import type { Crop } from '../state/inspecting.ts';
import { countOf } from '../state/selecting.ts';
import { add, clamp, scale, subtract, type Vec3, withAxis } from '../state/vec3.ts';
import { drawCrop } from './draw-crop.ts';
import type { EditHistory } from './edit-history.ts';
import { type InspectTools, shownLook } from './inspect-tools.ts';
import { without } from './row-masks.ts';

type Box = Pick<Crop, 'min' | 'max'>;

/** `box` with another minimum or maximum along an axis; the opposite face yields if necessary. */
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

/** Centre of a face of the box. */
export function faceMiddle({ min, max }: Box, side: 'min' | 'max', axis: number): Vec3 {
  return withAxis(scale(add(min, max), 0.5), axis, { min, max }[side][axis]);
}

/** Room between the scene's box and its outermost centres, whose float32 values are rounded. */
const ROOM = 1e-3;

/** `box` with room around it, in proportion to its longest edge. */
function widened({ min, max }: Box): Box {
  const room = ROOM * Math.max(...subtract(max, min)) || ROOM;
  return { min: subtract(min, [room, room, room]), max: add(max, [room, room, room]) };
}

/** Number of slider steps. */
export const SLIDER_STEPS = 400;

interface SliderRange {
  readonly low: number;
  readonly high: number;
  /** Between `low` and `high`; steps are finest around it. */
  readonly middle: number;
}

/** The value at a slider's `position`: cubic from the middle to both ends. */
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

/** Crops the scene to a box, in the image and in saved files. */
export class Cropping {
  readonly #tools: InspectTools;
  readonly #history: EditHistory;
  #isCounting = false;

  constructor(tools: InspectTools, history: EditHistory) {
    this.#tools = tools;
    this.#history = history;
  }

  /** A box around all splats of the scene, in its own space; null without a scene. */
  get sceneBox(): Box | null {
    const scene = this.#tools.viewer.scenes.newest;
    return scene && widened(boundsOf(scene.clouds, 'bounds'));
  }

  /** The sphere framed by the scene's first view, in the scene's own space. */
  get place(): Pick<ScenePlace, 'center' | 'radius'> {
    const { store, viewer } = this.#tools;
    const { center, radius } = scenePlaceOf(viewer);
    return { center: store.getState().isFlipped ? flippedPoint(center) : center, radius };
  }

  /**
   * Crops to `crop` from the next frame on; null: no crop.
   *
   * @param gesture successive crops with the same gesture are one undo step.
   */
  set(crop: Crop | null, gesture: unknown = null): void {
    this.#history.edit('crop', { crop }, gesture);
    this.count();
  }

  /** Starts with a box around all splats: nothing is hidden before a face is moved. */
  begin(): void {
    const { sceneBox } = this;
    if (sceneBox) this.set({ ...sceneBox, keep: 'inside' });
  }

  /**
   * Crops to the part of the scene in the cube around the sphere that the first view frames. Its
   * faces are mostly in the picture, unlike those of a box around a sky.
   */
  cropToSubject(): void {
    const { sceneBox, place } = this;
    if (!sceneBox) return;
    const side = (way: 1 | -1) =>
      place.center.map((value, axis) =>
        clamp(value + way * place.radius, sceneBox.min[axis], sceneBox.max[axis]),
      ) as unknown as Vec3;
    this.set({ min: side(-1), max: side(1), keep: 'inside' });
  }

  /** Draws the cropped scene in its current orientation. */
  draw(): void {
    drawCrop(this.#tools);
  }

  /** Counts the remaining splats, unless the number is known. */
  count(): void {
    const { crop, cropCount } = this.#tools.store.getState().inspecting;
    if (crop && cropCount === null) void this.#count();
  }

  /** Crops to the smallest box with all splats whose centres are in the image. */
  async cropToView(): Promise<void> {
    const { reader, update } = this.#tools;
    const look = shownLook(this.#tools);
    if (!look) return;
    const bounds = await reader.ask('seen', look);
    if (bounds === null) update({ problem: 'No splat is within the picture.' });
    if (bounds) this.set({ min: bounds.min, max: bounds.max, keep: 'inside' });
  }

  /**
   * Counts the remaining splats. During a drag, each count is followed by one for the newest box
   * only.
   */
  async #count(): Promise<void> {
    if (this.#isCounting) return;
    const { store, viewer, reader, update } = this.#tools;
    const { crop, selecting } = store.getState().inspecting;
    const scene = viewer.scenes.newest;
    if (!crop || !scene) return;
    this.#isCounting = true;
    const found = await reader.ask('within', { region: { kind: 'all' }, crop });
    this.#isCounting = false;
    if (!found) return;
    const now = store.getState().inspecting;
    const isCurrent = now.crop === crop && now.selecting.removed === selecting.removed;
    if (!isCurrent || viewer.scenes.newest !== scene) return this.#count();
    const keys = cloudKeys(scene);
    const kept = new Map(found.map((words, i) => [keys[i], words]));
    update({ cropCount: countOf(without(kept, selecting.removed)) });
  }
}
