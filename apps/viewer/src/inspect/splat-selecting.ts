import type { SplatPick } from '@websplatter/core';
import { flippedPoint } from '../camera/flip.ts';
import { movedInPicture, type PictureSpace } from '../camera/picture-space.ts';
import { scenePlaceOf } from '../engine/scene-place.ts';
import { cloudKeys } from '../engine/shown-scene.ts';
import { baseColorOf } from '../scene/base-color.ts';
import type { Region } from '../scene/inspect-messages.ts';
import type { DragRegion, PickedRegion, RowMasks, Selecting, SelectMode } from '../state/selecting.ts';
import { subtract, type Vec3 } from '../state/vec3.ts';
import type { EditHistory } from './edit-history.ts';
import { type InspectTools, shownLook } from './inspect-tools.ts';
import { pickSplat } from './pick-splat.ts';
import { joined, selectedWith, without } from './row-masks.ts';

const NONE: RowMasks = new Map();
/** Radius of the first sphere, as a part of the scene's radius. */
const FIRST_RADIUS = 0.1;
/** Significant digits of a radius, so that it is short to read. */
const RADIUS_DIGITS = 4;

/** One pick, which stays one edit while its radius or tolerance changes. */
interface Picking {
  readonly mode: SelectMode;
  /** The newest. */
  region: PickedRegion;
}

/** Selects splats by places in the picture, and removes them. */
export class SplatSelecting {
  readonly #tools: InspectTools;
  readonly #history: EditHistory;
  #picking: Picking | null = null;
  /** The pick whose splats are being found. */
  #asked: Picking | null = null;

  constructor(tools: InspectTools, history: EditHistory) {
    this.#tools = tools;
    this.#history = history;
  }

  /** Sets the options of the next selection. */
  choose(change: Partial<Selecting>): void {
    this.#tools.update({ selecting: { ...this.now, ...change } });
  }

  /** Selects splats, at any depth, with centres under a drag in an image of this size, CSS px. */
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

  /** Radius of the next sphere, scene units. */
  get sphereRadius(): number {
    return this.now.sphereRadius ?? shortened(FIRST_RADIUS * scenePlaceOf(this.#tools.viewer).radius);
  }

  set sphereRadius(sphereRadius: number) {
    this.choose({ sphereRadius });
    const { picked } = this.now;
    if (picked?.kind === 'sphere') this.#change({ ...picked, radius: sphereRadius });
  }

  /** How far channels may be from the colour that was picked, or is picked next; 0…255. */
  set tolerance(tolerance: number) {
    this.choose({ tolerance });
    const { picked } = this.now;
    if (picked?.kind === 'color') this.#change({ ...picked, tolerance });
  }

  /** The place of the scene that is seen at these parts of the image from its top left. */
  async centerAt(xPart: number, yPart: number): Promise<Vec3 | null> {
    const pick = await this.#pickAt(xPart, yPart);
    return pick && this.#turned(pick.point);
  }

  /** The radius around `center` of a pointer that has moved by these CSS pixels, scene units. */
  radiusTo(center: Vec3, space: PictureSpace, rightPx: number, downPx: number): number {
    const seen = this.#turned(center);
    return shortened(Math.hypot(...subtract(movedInPicture(space, seen, rightPx, downPx), seen)));
  }

  /** Selects the splats in a sphere; the next sphere begins with its radius. */
  async selectSphere(center: Vec3, radius: number, mode: SelectMode): Promise<void> {
    this.choose({ sphereRadius: radius });
    await this.#selectPicked({ mode, region: { kind: 'sphere', center, radius } });
  }

  /** Selects by the splat that is seen there, with the tool that is chosen. */
  async pickAt(xPart: number, yPart: number, mode: SelectMode): Promise<void> {
    const { tool } = this.now;
    if (tool === 'color') await this.#selectColorAt(xPart, yPart, mode);
    if (tool !== 'sphere') return;
    const center = await this.centerAt(xPart, yPart);
    if (center) await this.selectSphere(center, this.sphereRadius, mode);
  }

  /** All splats with about the base colour of the one that is seen there. */
  async #selectColorAt(xPart: number, yPart: number, mode: SelectMode): Promise<void> {
    const pick = await this.#pickAt(xPart, yPart);
    if (!pick) return;
    const { cloudIndex, splatIndex: row } = pick;
    const set = await this.#tools.reader.ask('splat', { cloudIndex, row });
    if (!set) return;
    const { tolerance } = this.now;
    await this.#selectPicked({ mode, region: { kind: 'color', color: baseColorOf(set, 0), tolerance } });
  }

  /** Selects all others that are not removed. */
  async invert(): Promise<void> {
    const all = await this.#rowsWithin({ kind: 'all' });
    if (!all) return;
    const { selected, removed } = this.now;
    this.#history.edit('Invert the selection', { selected: without(without(all, removed), selected) });
  }

  clear(): void {
    this.#history.edit('Clear the selection', { selected: NONE });
  }

  /** Leaves the selected splats out of the picture and of saved files. */
  remove(): void {
    const { selected, removed } = this.now;
    if (selected.size === 0) return;
    this.#history.edit('Remove splats', { selected: NONE, removed: joined(removed, selected) });
  }

  /** Brings all removed splats back. */
  restore(): void {
    this.#history.edit('Bring splats back', { removed: NONE });
  }

  get now(): Selecting {
    return this.#tools.store.getState().inspecting.selecting;
  }

  async #pickAt(xPart: number, yPart: number): Promise<SplatPick | null> {
    const pick = await pickSplat(this.#tools, xPart, yPart);
    if (!pick) this.#tools.update({ problem: 'No splat is drawn there.' });
    return pick;
  }

  /** From the scene's own space to the world that the camera sees, and back. */
  #turned(point: Vec3): Vec3 {
    return this.#tools.store.getState().isFlipped ? flippedPoint(point) : point;
  }

  /** Gives the last pick another region. */
  #change(region: PickedRegion): void {
    if (!this.#picking) return;
    this.#picking.region = region;
    void this.#selectPicked(this.#picking);
  }

  /**
   * Selects the splats of a pick in place of its earlier ones. While its region changes fast, only
   * the newest region is read after each answer.
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
    this.#history.edit('Select splats', { selected }, gesture);
    if (found.size === 0) this.#tools.update({ problem: 'No splat has its centre there.' });
  }

  /** Undefined if the scene cannot be read. */
  async #rowsWithin(region: Region): Promise<RowMasks | undefined> {
    const { store, reader, viewer } = this.#tools;
    const scene = viewer.scenes.newest;
    if (!scene) return undefined;
    const { crop } = store.getState().inspecting;
    const found = await reader.ask('within', { region, crop });
    if (!found) return undefined;
    const keys = cloudKeys(scene);
    return without(new Map(found.map((words, i) => [keys[i], words])), NONE);
  }
}

function shortened(radius: number): number {
  return Number(radius.toPrecision(RADIUS_DIGITS));
}
