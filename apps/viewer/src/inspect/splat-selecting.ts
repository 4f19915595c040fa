import type { SplatPick } from '@websplatter/core';
import { formatSplats } from '@websplatter/kit/format';
import { flippedPoint } from '../camera/flip.ts';
import { movedInPicture, type PictureSpace } from '../camera/picture-space.ts';
import { cloudKeys } from '../engine/open/shown-scene.ts';
import { hiddenPoints } from '../engine/show/hidden-points.ts';
import { scenePlaceOf } from '../engine/show/scene-place.ts';
import { baseColorOf } from '../scene/base-color.ts';
import type { Region } from '../scene/inspect-messages.ts';
import {
  countOf,
  type DragRegion,
  type PickedRegion,
  type RowMasks,
  type Selecting,
  type SelectMode,
} from '../state/selecting.ts';
import { subtract, type Vec3 } from '../state/vec3.ts';
import type { EditHistory } from './edit-history.ts';
import { type InspectTools, shownLook } from './inspect-tools.ts';
import { pickSplat } from './pick-splat.ts';
import { joined, selectedWith, without } from './row-masks.ts';

const NONE: RowMasks = new Map();
/** Default radius of spheres, as a fraction of the scene's radius. */
const FIRST_RADIUS = 0.1;
/** Splats that are asked whether others hide them: their share is then known to about 3 %. */
const ASKED_IF_HIDDEN = 256;
/** Significant digits of a radius, so that it is short. */
const RADIUS_DIGITS = 4;

/** A pick, which stays one undo step while its radius or tolerance changes. */
interface Picking {
  readonly mode: SelectMode;
  /** The newest region. */
  region: PickedRegion;
}

/** Selects splats by positions in the picture, and removes them. */
export class SplatSelecting {
  readonly #tools: InspectTools;
  readonly #history: EditHistory;
  #picking: Picking | null = null;
  /** The pick whose splats are being searched. */
  #asked: Picking | null = null;
  /** Settles when the newest count is done. */
  #counted: Promise<unknown> = Promise.resolve();

  constructor(tools: InspectTools, history: EditHistory) {
    this.#tools = tools;
    this.#history = history;
  }

  /** Changes options for the next selection. Another tool begins without the problem of the one before. */
  choose(change: Partial<Selecting>): void {
    const isOtherTool = change.tool !== undefined && change.tool !== this.now.tool;
    this.#tools.update({ selecting: { ...this.now, ...change }, ...(isOtherTool && { problem: null }) });
  }

  /**
   * Selects splats, at any depth, whose centres are in the dragged region of an image of this size,
   * CSS px.
   */
  async selectDragged(dragged: DragRegion, width: number, height: number, mode: SelectMode): Promise<void> {
    const look = shownLook(this.#tools);
    if (look) await this.select({ kind: 'dragged', dragged, width, height, look }, mode);
  }

  /** Selects all splats in the image. */
  async selectSeen(): Promise<void> {
    await this.selectDragged({ kind: 'rectangle', from: [0, 0], to: [1, 1] }, 1, 1, this.now.mode);
  }

  async select(region: Region, mode = this.now.mode): Promise<void> {
    const found = await this.#rowsWithin(region);
    if (found) this.#take(found, mode, null);
  }

  /**
   * Counts the splats that `select` would find, after earlier counts. Resolves with undefined if
   * the scene cannot be read, or if the count is no longer wanted when its turn comes.
   *
   * @param onPart called with the fraction done, 0…1, if that takes long.
   */
  count(
    region: Region,
    isWanted: () => boolean,
    onPart: (part: number) => void,
  ): Promise<number | undefined> {
    const counted = this.#counted.then(async () => {
      const found = isWanted() ? await this.#rowsWithin(region, onPart) : undefined;
      return found && countOf(without(found, this.now.removed));
    });
    this.#counted = counted;
    return counted;
  }

  /** Radius of the next sphere, scene units. */
  get sphereRadius(): number {
    return this.now.sphereRadius ?? shortened(FIRST_RADIUS * scenePlaceOf(this.#tools.viewer).radius);
  }

  set sphereRadius(sphereRadius: number) {
    this.choose({ sphereRadius });
    const { picked } = this.now;
    if (picked?.kind === 'sphere') this.#change({ ...picked, radius: sphereRadius });
  }

  /** Largest channel difference from the picked colour, 0…255; also applies to the next pick. */
  set tolerance(tolerance: number) {
    this.choose({ tolerance });
    const { picked } = this.now;
    if (picked?.kind === 'color') this.#change({ ...picked, tolerance });
  }

  /**
   * The scene point that is visible at these fractions of the image from its top left; null if none
   * is.
   */
  async centerAt(xPart: number, yPart: number): Promise<Vec3 | null> {
    const pick = await this.#pickAt(xPart, yPart);
    return pick && this.#turned(pick.point);
  }

  /**
   * The radius of a sphere around `center` after the pointer has moved by these CSS pixels, scene
   * units.
   */
  radiusTo(center: Vec3, space: PictureSpace, rightPx: number, downPx: number): number {
    const seen = this.#turned(center);
    return shortened(Math.hypot(...subtract(movedInPicture(space, seen, rightPx, downPx), seen)));
  }

  /** Selects the splats in a sphere; its radius is the default for the next one. */
  async selectSphere(center: Vec3, radius: number, mode: SelectMode): Promise<void> {
    this.choose({ sphereRadius: radius });
    await this.#selectPicked({ mode, region: { kind: 'sphere', center, radius } });
  }

  /** Selects by the visible splat at this position, with the active tool. */
  async pickAt(xPart: number, yPart: number, mode: SelectMode): Promise<void> {
    const { tool } = this.now;
    if (tool === 'color') await this.#selectColorAt(xPart, yPart, mode);
    if (tool !== 'sphere') return;
    const center = await this.centerAt(xPart, yPart);
    if (center) await this.selectSphere(center, this.sphereRadius, mode);
  }

  /** Selects all splats with about the base colour of the visible splat at this position. */
  async #selectColorAt(xPart: number, yPart: number, mode: SelectMode): Promise<void> {
    const pick = await this.#pickAt(xPart, yPart);
    if (!pick) return;
    const { cloudIndex, row } = pick;
    const set = await this.#tools.reader.ask('splat', { cloudIndex, row });
    if (!set) return;
    const { tolerance } = this.now;
    await this.#selectPicked({ mode, region: { kind: 'color', color: baseColorOf(set, 0), tolerance } });
  }

  /**
   * Share of the selected splats in the picture that others hide, 0…1, of a sample; null if none is in the
   * picture, or if the scene cannot be read.
   */
  async hiddenPart(): Promise<number | null> {
    const { reader, viewer } = this.#tools;
    const scene = viewer.scenes.newest;
    if (!scene) return null;
    const rows = cloudKeys(scene).map((key) => this.now.selected.get(key) ?? null);
    const centers = await reader.ask('sample', { rows, most: ASKED_IF_HIDDEN });
    const hidden = (centers && (await hiddenPoints(viewer, centers)))?.filter((each) => each !== null);
    return hidden && hidden.length > 0 ? hidden.filter(Boolean).length / hidden.length : null;
  }

  /** Selects all other splats that are not removed. */
  async invert(): Promise<void> {
    const all = await this.#rowsWithin({ kind: 'all' });
    if (!all) return;
    const { selected, removed } = this.now;
    this.#history.edit('inverted selection', { selected: without(without(all, removed), selected) });
  }

  clear(): void {
    this.#history.edit('cleared selection', { selected: NONE });
  }

  /** Hides the selected splats and leaves them out of saved files. */
  remove(): void {
    const { selected, removed } = this.now;
    if (selected.size === 0) return;
    this.#history.edit(`removal of ${formatSplats(countOf(selected))}`, {
      selected: NONE,
      removed: joined(removed, selected),
    });
  }

  /** Restores all removed splats. */
  restore(): void {
    this.#history.edit('return of all removed splats', { removed: NONE });
  }

  get now(): Selecting {
    return this.#tools.store.getState().inspecting.selecting;
  }

  async #pickAt(xPart: number, yPart: number): Promise<SplatPick | null> {
    const pick = await pickSplat(this.#tools, xPart, yPart);
    if (!pick) this.#tools.update({ problem: 'No splat is drawn there.' });
    return pick;
  }

  /** Converts between the scene's own space and the camera's world. */
  #turned(point: Vec3): Vec3 {
    return this.#tools.store.getState().isFlipped ? flippedPoint(point) : point;
  }

  /** Changes the region of the last pick. */
  #change(region: PickedRegion): void {
    if (!this.#picking) return;
    this.#picking.region = region;
    void this.#selectPicked(this.#picking);
  }

  /**
   * Replaces a pick's earlier selection. While its region changes quickly, only the newest region
   * is searched after each answer.
   */
  async #selectPicked(picking: Picking): Promise<void> {
    const { mode, region } = picking;
    this.#picking = picking;
    this.choose({ picked: region });
    if (this.#asked === picking) return;
    this.#asked = picking;
    const found = await this.#rowsWithin(region);
    this.#asked = null;
    if (!found) return;
    if (picking.region !== region) return this.#selectPicked(picking);
    const { picked } = this.now;
    this.#take(found, mode, picking);
    this.choose({ picked: picked ?? region });
  }

  #take(found: RowMasks, mode: SelectMode, gesture: Picking | null): void {
    const selected = selectedWith(mode, this.#history.before(gesture), found);
    // Where nothing was selected before and after, there is nothing to undo.
    if (selected.size + this.now.selected.size > 0) this.#history.edit('selection', { selected }, gesture);
    if (found.size === 0) this.#tools.update({ problem: 'No splat has its centre there.' });
  }

  /** Resolves with undefined if the scene cannot be read. */
  async #rowsWithin(region: Region, onPart?: (part: number) => void): Promise<RowMasks | undefined> {
    const { store, reader, viewer } = this.#tools;
    const scene = viewer.scenes.newest;
    if (!scene) return undefined;
    const { crop } = store.getState().inspecting;
    const found = await reader.ask('within', { region, crop }, onPart);
    if (!found) return undefined;
    const keys = cloudKeys(scene);
    return without(new Map(found.map((words, i) => [keys[i], words])), NONE);
  }
}

function shortened(radius: number): number {
  return Number(radius.toPrecision(RADIUS_DIGITS));
}
