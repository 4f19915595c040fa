import { canLink } from '../engine/link/page-address.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { describeEdits } from '../state/describe-edits.ts';
import { FieldError } from '../state/json-fields.ts';
import { NOT_FETCHED, withKept } from '../state/messages.ts';
import type { KeptVersion } from '../state/scene.ts';
import type { ViewerState } from '../state/store.ts';
import { tellFailure } from '../state/tell-failure.ts';
import { hasSameEdits, keptWork } from './kept-work.ts';
import {
  browserVersions,
  type Version,
  type VersionMoment,
  type VersionPlace,
  type VersionStore,
} from './version-store.ts';

/** Work is kept this long after the last change, ms. */
const KEEP_DELAY_MS = 300;

/**
 * Keeps what is made of each scene in the browser. After a reload of the tab, the scene comes back as
 * it was. When the same files are opened another time, their edits are offered. Returns a function
 * that stops this.
 */
export function keepWork(panel: PanelProps, kept: VersionStore = browserVersions()): () => void {
  const keeper = new WorkKeeper(panel, kept);
  return keeper.watch();
}

/**
 * Each opening of a scene makes a version of its own, so that no visit and no tab ever replaces the
 * work of another one. A version that was brought back is offered no more while its edits are on the
 * screen, or are in a version that was kept later.
 */
class WorkKeeper {
  readonly #panel: PanelProps;
  readonly #kept: VersionStore;
  /** The scene that was opened last. */
  #opening: Opening | null = null;
  /** The version that is kept now; null until what was kept before is known. */
  #place: VersionPlace | null = null;
  /** The version of this tab before the page was loaded again, until it has come back. */
  #before: VersionPlace | null;
  /** Versions whose edits are on the screen, as they were when they came. */
  #included: readonly VersionMoment[] = [];
  #hasRecord = false;
  /** What other tabs know. */
  #toldEdits = '';
  #release = () => {};
  #timer: ReturnType<typeof setTimeout> | undefined;
  /** Writes follow one another, so that the newest is the last. */
  #keeping = Promise.resolve();

  constructor(panel: PanelProps, kept: VersionStore) {
    this.#panel = panel;
    this.#kept = kept;
    this.#before = kept.versionOfTab;
  }

  watch(): () => void {
    const { store } = this.#panel;
    const listeners = new AbortController();
    const { signal } = listeners;
    this.#follow(store.getState(), store.getState());
    const unsubscribe = store.subscribe((state, before) => this.#follow(state, before));
    const unwatch = this.#kept.watch((key) => {
      if (key === this.#place?.key) void this.#offer();
    });
    addEventListener('beforeunload', (event) => this.#leave(event), { signal });
    // Another tab may have been closed.
    addEventListener('focus', () => store.getState().keptVersions && void this.#offer(), { signal });
    return () => {
      clearTimeout(this.#timer);
      unsubscribe();
      unwatch();
      listeners.abort();
      this.#release();
    };
  }

  #follow(state: ViewerState, before: ViewerState): void {
    const opening = shownOpening(this.#panel);
    if (opening && opening.id !== this.#opening?.id) void this.#begin(opening);
    else if (KEPT.some((name) => state[name] !== before[name])) this.#keepSoon();
  }

  #leave(event: BeforeUnloadEvent): void {
    if (this.#timer !== undefined) void this.#keep();
    if (this.#panel.store.getState().unkept.size > 0) event.preventDefault();
  }

  #keepSoon(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#keep(), KEEP_DELAY_MS);
  }

  #keep(): Promise<void> {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    this.#keeping = this.#keeping.then(() => this.#write());
    return this.#keeping;
  }

  async #write(): Promise<void> {
    const { store, viewer } = this.#panel;
    const state = store.getState();
    const place = this.#place;
    if (!place || shownOpening(this.#panel)?.id !== this.#opening?.id) return;
    const edits = describeEdits(state.inspecting);
    const sources = viewer.scenes.newest?.parts.map(({ source }) => source) ?? [];
    // Addresses have the view of files on servers.
    const isNeeded = edits !== '' || !canLink(sources);
    if (isNeeded || this.#hasRecord) {
      const work = {
        ...keptWork(viewer, state),
        ...{ edits, savedAtMs: Date.now(), includes: this.#included },
      };
      this.#hasRecord = isNeeded;
      const failure = await failureOf(isNeeded ? this.#kept.write(place, work) : this.#kept.clear(place));
      if (this.#place !== place) return;
      // A camera that was moved is no work.
      const hasWork = edits !== '' || state.past.length > 0;
      store.setState((now) => withKept(now, 'edits', hasWork ? failure : null));
      if (failure !== null) return;
    }
    this.#kept.versionOfTab = place;
    if (edits !== this.#toldEdits) this.#kept.tell(place.key);
    this.#toldEdits = edits;
  }

  async #begin(opening: Opening): Promise<void> {
    const { store, viewer } = this.#panel;
    const { key } = opening;
    this.#opening = opening;
    this.#place = null;
    this.#release();
    this.#included = [];
    store.setState((state) => ({ ...withKept(state, 'edits'), keptVersions: null }));
    const versions = await this.#read(key);
    const state = store.getState();
    if (this.#opening !== opening || !state.scene) return;
    const before = versions.find(({ id }) => this.#before?.key === key && this.#before.id === id);
    for (const { id } of spent(versions))
      if (id !== before?.id) void failureOf(this.#kept.clear({ key, id }));
    if (describeEdits(state.inspecting) !== '') {
      // They came back with their scene, or with a project.
      const work = keptWork(viewer, state);
      this.#included = versions.filter((version) => hasSameEdits(version.work, work)).flatMap(momentsOf);
    } else if (before) {
      this.#before = null;
      const isGiven = await this.#give(before);
      const { edits } = before.work;
      if (isGiven && edits !== '') {
        const text = `${state.scene.title} is as you left it, with ${edits}.`;
        store.setState({ notice: { text, offers: [{ label: 'Undo', command: 'undo' }] } });
      }
    }
    if (this.#opening !== opening) return;
    this.#startVersion(key);
    if (!before) this.#kept.versionOfTab = this.#place;
    const newest = (await this.#offer())?.find(({ isElsewhere }) => !isElsewhere);
    if (newest && !store.getState().leftScene)
      store.setState({ leftScene: { title: state.scene.title, bringBack: newest.bringBack } });
    this.#keepSoon();
  }

  #startVersion(key: string): void {
    this.#release();
    const id = crypto.randomUUID();
    this.#release = this.#kept.hold(id);
    this.#place = { key, id };
    this.#hasRecord = false;
    this.#toldEdits = '';
  }

  /** Lists the other versions of the scene. Returns them, or undefined if it is no longer shown. */
  async #offer(): Promise<readonly KeptVersion[] | undefined> {
    const { store } = this.#panel;
    const place = this.#place;
    if (!place) return undefined;
    const versions = await this.#read(place.key);
    if (this.#place !== place) return undefined;
    const others = versions.filter(({ id, work }) => id !== place.id && work.edits !== '');
    const known = new Set(
      [...others.map(({ work }) => work.includes ?? []), this.#included].flat().map(String),
    );
    const offered = others
      .filter((version) => !known.has(String(momentOf(version))))
      .toSorted((a, b) => b.work.savedAtMs - a.work.savedAtMs)
      .map((version) => ({
        id: version.id,
        edits: version.work.edits,
        savedAtMs: version.work.savedAtMs,
        isElsewhere: version.isOpen,
        bringBack: () => {
          store.setState({ leftScene: null, notice: null });
          void this.#bringBack(version);
        },
      }));
    const isElsewhere = others.some(({ isOpen }) => isOpen);
    const isAny = offered.length > 0 || isElsewhere;
    store.setState({ keptVersions: isAny ? { isElsewhere, versions: offered } : null });
    return offered;
  }

  /** Shows a version in place of the edits on the screen, which become a version of their own unless they are one. */
  async #bringBack(version: Version): Promise<void> {
    const { store } = this.#panel;
    await this.#keep();
    const place = this.#place;
    if (!place) return;
    if (describeEdits(store.getState().inspecting) !== '') {
      const versions = await this.#read(place.key);
      if (this.#place !== place) return;
      const left = versions.find(({ id }) => id === place.id);
      const isKept = versions.some((each) => each !== left && left && hasSameEdits(each.work, left.work));
      if (left && !isKept) {
        this.#startVersion(place.key);
        this.#included = momentsOf(left);
      }
    }
    await this.#give(version);
  }

  /** Returns whether it fits the scene; if not, the store has a failure. */
  async #give(version: Version): Promise<boolean> {
    const { store, viewer } = this.#panel;
    const code = await Promise.all([import('./give-work.ts'), import('./mask-rows.ts')]).catch(() => {
      store.setState({ notice: NOT_FETCHED });
      return null;
    });
    if (!code) return false;
    const [{ giveWork }, { checkMasks, rowsIn }] = code;
    const parts = viewer.scenes.newest?.parts ?? [];
    try {
      checkMasks(version.work.removed, rowsIn(parts));
    } catch (error) {
      if (!(error instanceof FieldError)) throw error;
      const title = `${version.work.edits} cannot be brought back`;
      const advice = 'The file may have changed since then.';
      tellFailure(store, error, { title, advice });
      return false;
    }
    const before = this.#included;
    const show = (included: readonly VersionMoment[]) => {
      this.#included = included;
      void this.#offer();
    };
    const keys = parts.map((part) => part.key);
    const included = momentsOf(version);
    giveWork(this.#panel, version.work, 'restored edits', keys, {
      do: () => show(included),
      undo: () => show(before),
    });
    return true;
  }

  #read(key: string): Promise<readonly Version[]> {
    // A browser without storage has no versions; that nothing is kept is said at the first edit.
    return this.#kept.read(key).catch(() => []);
  }
}

/** Parts of the state after whose change there may be other work. */
const KEPT = ['inspecting', 'requested', 'scene', 'look', 'viewMode', 'accuracy', 'restedFrames'] as const;

/** A scene on the screen, from when it was opened until another one takes its place. */
interface Opening {
  /** Contents of its files. */
  readonly key: string;
  /** Of its files: the same file has another one when it is opened anew. */
  readonly id: string;
}

/** Null while a file is being opened. */
function shownOpening({ store, viewer }: PanelProps): Opening | null {
  const { load, scene } = store.getState();
  const parts = viewer.scenes.newest?.parts;
  if (load !== null || !scene || !parts) return null;
  return {
    key: parts.map(({ contentKey }) => contentKey).join('\n'),
    id: parts.map(({ key }) => key).join(),
  };
}

function momentOf({ id, work }: Pick<Version, 'id' | 'work'>): VersionMoment {
  return [id, work.savedAtMs];
}

/** A version with all that were brought back into it. */
function momentsOf(version: Pick<Version, 'id' | 'work'>): readonly VersionMoment[] {
  return [momentOf(version), ...(version.work.includes ?? [])];
}

/** Versions of no tab that have no edits, or whose edits are in another one of no tab. */
function spent(versions: readonly Version[]): readonly Version[] {
  const closed = versions.filter(({ isOpen }) => !isOpen);
  const known = new Set(closed.flatMap(({ work }) => work.includes ?? []).map(String));
  return closed.filter((version) => version.work.edits === '' || known.has(String(momentOf(version))));
}

/** Null if it resolves. */
function failureOf(work: Promise<unknown>): Promise<unknown> {
  return work.then(
    () => null,
    (error: unknown) => error ?? new Error('refused'),
  );
}
