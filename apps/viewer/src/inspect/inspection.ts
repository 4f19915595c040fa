import { highlight } from '@websplatter/core/effects';
import { Tap } from '../camera/tap.ts';
import { cloudKeys } from '../engine/open/shown-scene.ts';
import { cloudSources } from '../engine/open/stored-source.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { CloudToRead } from '../scene/inspect-messages.ts';
import { sceneFile } from '../scene/scene-file.ts';
import {
  type InspectedSplat,
  type Inspecting,
  type MarkedBin,
  NOTHING_INSPECTED,
} from '../state/inspecting.ts';
import { NOTHING_SELECTED, type RowMasks, type SelectMode } from '../state/selecting.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import type { Vec3 } from '../state/vec3.ts';
import { keyScope } from '../ui/key-scope.ts';
import { Cropping } from './cropping.ts';
import { EditHistory } from './edit-history.ts';
import type { InspectTools } from './inspect-tools.ts';
import { selectionOf } from './row-masks.ts';
import { Rulers } from './rulers.ts';
import { SceneReader } from './scene-reader.ts';
import { listenToSelectDrags, modeOf } from './select-drag.ts';
import { SplatInspector } from './splat-inspector.ts';
import { SplatSelecting } from './splat-selecting.ts';
import { splitSelection } from './split-selection.ts';

/** Props of the panel's parts. */
export interface InspectProps {
  readonly store: ViewerStore;
  readonly inspection: Inspection;
}

/** Share of the mark's colour in marked splats. */
const MARK_STRENGTH = 0.75;
/** Colour of marks until the scene's colours are known, sRGB: few scenes contain it. */
const FIRST_MARK_COLOR: Vec3 = [1, 0.1, 0.85];

/** The logic of the panel Inspect, without its interface. */
export class Inspection {
  readonly splats: SplatInspector;
  readonly rulers: Rulers;
  readonly histograms: HistogramMarks;
  readonly cropping: Cropping;
  readonly selecting: SplatSelecting;
  /** Makes the selection a file of its own, beside the others. */
  readonly splitSelection: () => Promise<void>;
  readonly #store: ViewerStore;
  readonly #viewer: Viewer;
  readonly #reader: SceneReader;
  /** Colour of marks; null until the scene's colours were asked for. */
  #markColor: Vec3 | null = null;
  /** Arguments of the last call that drew marks. */
  #drawnMark: readonly unknown[] = [];

  constructor(viewer: Viewer, store: ViewerStore) {
    this.#store = store;
    this.#viewer = viewer;
    const update = (change: Partial<Inspecting>) =>
      store.setState(({ inspecting }) => ({ inspecting: { ...inspecting, ...change } }));
    this.#reader = new SceneReader(
      () => this.#clouds(),
      (reading) => update({ reading }),
    );
    const tools: InspectTools = { store, viewer, reader: this.#reader, update };
    this.splats = new SplatInspector(tools);
    this.histograms = new HistogramMarks(tools);
    const history = new EditHistory(tools);
    this.splitSelection = () =>
      splitSelection(
        {
          store,
          update,
          viewer,
          write: (request) =>
            sceneFile(
              request,
              () => {},
              () => {},
            ),
        },
        history,
      );
    this.rulers = new Rulers({ ...tools, storage: () => localStorage }, history);
    this.cropping = new Cropping(tools, history);
    this.selecting = new SplatSelecting(tools, history);
  }

  /** Follows the store and the pointer; returns a function that stops this. */
  watch(): () => void {
    const listeners = new AbortController();
    const { signal } = listeners;
    const tap = new Tap();
    addEventListener('pointerdown', (event) => tap.pointerDown(event, isPicking(event)), { signal });
    addEventListener('pointerup', (event) => tap.pointerUp(event) && this.#tapped(event), { signal });
    listenToSelectDrags({ store: this.#store, viewer: this.#viewer }, this.selecting, signal);
    addEventListener('keydown', (event) => this.#keyPressed(event), { signal });
    // The URL's crop may have arrived after the scene was flipped.
    if (this.#store.getState().inspecting.crop) this.cropping.draw();
    this.#open(this.#store.getState());
    const unsubscribe = this.#store.subscribe((state, before) => this.#follow(state, before));
    return () => {
      unsubscribe();
      listeners.abort();
      this.#close();
    };
  }

  /** Acts like a click in the middle of the image. */
  pickMiddle(): void {
    this.#pick(...this.#viewer.camera.middle, this.selecting.now.mode);
  }

  /** Removes the selected splats by key while the panel is open. */
  #keyPressed(event: KeyboardEvent): void {
    const { dock, isHelpVisible } = this.#store.getState();
    if (dock !== 'inspect' || isHelpVisible || event.altKey || keyScope(event.target) === 'text') return;
    const hasModifier = event.ctrlKey || event.metaKey || event.shiftKey;
    if (hasModifier || !['Delete', 'Backspace'].includes(event.key)) return;
    this.selecting.remove();
    event.preventDefault();
  }

  #tapped(event: PointerEvent): void {
    const { target, offsetX, offsetY } = event;
    const { dock, travelling, annotating } = this.#store.getState();
    const isInspecting = dock === 'inspect' && travelling === null && !annotating.isPlacing;
    if (!isInspecting || !(target instanceof HTMLElement)) return;
    const mode = modeOf(event, this.selecting);
    this.#pick(offsetX / target.clientWidth, offsetY / target.clientHeight, mode);
  }

  #pick(xPart: number, yPart: number, mode: SelectMode): void {
    const { tab } = this.#store.getState().inspecting;
    if (tab === 'distance') void this.rulers.markAt(xPart, yPart);
    else if (tab === 'splat') void this.splats.pickAt(xPart, yPart);
    else if (tab === 'select') void this.selecting.pickAt(xPart, yPart, mode);
  }

  #follow(state: ViewerState, before: ViewerState): void {
    const isOpen = state.dock === 'inspect';
    const { inspecting } = state;
    if (state.dock !== before.dock && before.dock === 'inspect') this.#close();
    // A reset by a new scene also replaces the splats.
    const isAnew = inspecting === NOTHING_INSPECTED && before.inspecting !== NOTHING_INSPECTED;
    const hasOtherParts = state.scene?.parts !== before.scene?.parts && before.scene !== null;
    if (isAnew || hasOtherParts) {
      this.#reader.close();
      this.histograms.forget();
      this.#markColor = null;
    }
    if (isOpen && (before.dock !== 'inspect' || isAnew)) this.#open(state);
    if (isOpen && inspecting.tab !== before.inspecting.tab) this.#showTab(state);
    if (state.isFlipped !== before.isFlipped) this.cropping.draw();
    if (isOpen && state.restedFrames !== before.restedFrames) this.splats.trace();
    if (inspecting !== before.inspecting) this.#mark();
    const { crop, cropCount, selecting } = before.inspecting;
    const isUncounted = inspecting.crop !== crop || inspecting.cropCount !== cropCount;
    if (isUncounted || inspecting.selecting.removed !== selecting.removed) this.cropping.count();
  }

  #open(state: ViewerState): void {
    if (state.dock !== 'inspect') return;
    this.rulers.readScale();
    this.splats.resume();
    this.#showTab(state);
    this.#mark();
  }

  /** Frees the worker's memory; a crop stays. */
  #close(): void {
    this.#reader.close();
    this.#mark();
  }

  #showTab({ inspecting }: ViewerState): void {
    if (inspecting.tab === 'histogram') void this.histograms.count();
    if (inspecting.tab === 'crop') this.cropping.count();
  }

  /**
   * Marks the inspected splat, the splats of a bin, or the selected splats, depending on the tab.
   */
  #mark(): void {
    const { dock, inspecting, scene, requested } = this.#store.getState();
    const { tab, splat, marked, selecting } = inspecting;
    const isShown = dock === 'inspect' && scene !== null;
    const row = isShown && tab === 'splat' && splat ? splat : null;
    const rows = !isShown
      ? null
      : tab === 'histogram' && marked
        ? this.histograms.rows
        : tab === 'select'
          ? selecting.selected
          : null;
    const masks = row ? this.#maskOf(row) : (rows ?? NOTHING_SELECTED.selected);
    if (masks.size > 0 && !this.#markColor && inspecting.reading.kind === 'done') void this.#findMarkColor();
    const color = this.#markColor ?? FIRST_MARK_COLOR;
    const mark = [scene, row?.row, row?.cloudIndex, rows, ...color];
    if (mark.every((each, i) => each === this.#drawnMark[i])) return;
    this.#drawnMark = mark;
    if (masks.size === 0 && requested.marked.size === 0) return;
    const uses = [...masks].map(([key, words]) => {
      const selection = selectionOf(words);
      return [key, [highlight({ selection, color, strength: MARK_STRENGTH })]] as const;
    });
    this.#viewer.setEffects('marked', new Map(uses));
  }

  /** Asks once for a colour that the scene has little of, then marks in it. */
  async #findMarkColor(): Promise<void> {
    this.#markColor = FIRST_MARK_COLOR;
    const color = await this.#reader.ask('markColor', null);
    if (!color) return;
    this.#markColor = color;
    this.#mark();
  }

  #maskOf({ cloudIndex, row }: InspectedSplat): RowMasks {
    const scene = this.#viewer.scenes.newest;
    const words = new Uint32Array((row >>> 5) + 1);
    words[row >>> 5] = 1 << (row & 31);
    return new Map(scene ? [[cloudKeys(scene)[cloudIndex], words]] : []);
  }

  async #clouds(): Promise<readonly CloudToRead[]> {
    const scene = this.#viewer.scenes.newest;
    if (!scene) return [];
    const shown = scene.parts.filter(({ look }) => !look.isHidden);
    const sources = await Promise.all(shown.map(cloudSources));
    return sources.flat().map((source, i) => {
      const modelMatrix = scene.clouds[i]?.modelMatrix;
      return { source, modelMatrix: modelMatrix ? Array.from(modelMatrix) : null };
    });
  }
}

function isPicking({ target, isPrimary, button }: PointerEvent): boolean {
  return isPrimary && button === 0 && target instanceof HTMLElement && target.matches('.viewport');
}

/** Computes histograms, and finds the splats of a bin. */
class HistogramMarks {
  readonly #tools: InspectTools;
  /** Rows of the marked bin; null until they are found. */
  #rows: RowMasks | null = null;

  constructor(tools: InspectTools) {
    this.#tools = tools;
  }

  get rows(): RowMasks | null {
    return this.#rows;
  }

  /** Computes the histograms, unless they are available. */
  async count(): Promise<void> {
    const { store, reader, update } = this.#tools;
    const { histograms, marked } = store.getState().inspecting;
    if (marked && !this.#rows) void this.mark(marked);
    if (histograms) return;
    const counted = await reader.ask('histograms', null);
    if (counted) update({ histograms: counted });
  }

  /** Discards the results when another scene is opened. */
  forget(): void {
    this.#rows = null;
  }

  /** Marks the splats of a bin in the image; null removes the marks. */
  async mark(marked: MarkedBin | null): Promise<void> {
    const { store, reader, viewer, update } = this.#tools;
    if (!marked) this.forget();
    update({ marked });
    const scene = viewer.scenes.newest;
    if (!marked || !scene) return;
    const masks = await reader.ask('within', { region: { kind: 'bin', marked }, crop: null });
    if (!masks || store.getState().inspecting.marked !== marked) return;
    const keys = cloudKeys(scene);
    this.#rows = new Map(masks.map((words, i) => [keys[i], words]));
    // A new object, so that subscribers redraw with the splats found.
    update({ marked: { ...marked } });
  }
}
