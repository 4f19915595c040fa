import { inTable } from '../engine/browser-table.ts';
import { canLink } from '../engine/page-address.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import { describeEdits } from '../state/describe-edits.ts';
import type { ViewerState } from '../state/store.ts';
import { type KeptWork, keptWork } from './kept-work.ts';

/** Work as the browser keeps it. */
export interface WorkRecord extends KeptWork {
  /** As `describeEdits`; empty if nothing but the view differs from the file. */
  readonly edits: string;
  readonly savedAtMs: number;
}

/** Where work is kept, by the contents of a scene's files. */
export interface WorkStore {
  read(key: string): Promise<WorkRecord | undefined>;
  write(key: string, work: WorkRecord): Promise<unknown>;
  clear(key: string): Promise<unknown>;
  /** The scene that this tab showed before it was loaded again, and that it shows from now on. */
  sceneOfTab: string | null;
}

/** Work is kept this long after the last change, ms. */
const KEEP_DELAY_MS = 300;

/**
 * Keeps what is made of each scene in the browser. After a reload of the tab, the scene comes back as
 * it was. When the same files are opened another time, their edits are offered. Returns a function
 * that stops this.
 */
export function keepWork(panel: PanelProps, kept: WorkStore = inBrowser()): () => void {
  const { store, viewer } = panel;
  /** The scene of this tab before the page was loaded again, until it has come back. */
  let sceneBefore = kept.sceneOfTab;
  let sceneKey: string | null = null;
  /** Whether there may be work of another visit, which a scene without edits must not replace. */
  let isWaiting = false;
  let hasRecord = false;
  let isUnkept = false;
  let timer: ReturnType<typeof setTimeout> | undefined;

  const keep = async () => {
    const state = store.getState();
    const key = sceneKey;
    const edits = describeEdits(state.inspecting);
    if (key === null || key !== shownKey(panel) || (isWaiting && edits === '')) return;
    const sources = viewer.scenes.newest?.parts.map(({ source }) => source) ?? [];
    // Addresses have the view of files on servers.
    const isNeeded = edits !== '' || !canLink(sources);
    if (!isNeeded && !hasRecord) return;
    const work = { ...keptWork(viewer, state), edits, savedAtMs: Date.now() };
    hasRecord = isNeeded;
    // The browser asks before the page with such edits is left: see `onLeave`.
    isUnkept = await (isNeeded ? kept.write(key, work) : kept.clear(key)).then(
      () => false,
      () => edits !== '',
    );
  };
  const keepSoon = () => {
    clearTimeout(timer);
    timer = setTimeout(() => void keep(), KEEP_DELAY_MS);
  };
  const give = async (work: WorkRecord) => {
    const { giveWork } = await import('./give-work.ts');
    isWaiting = false;
    const keys = viewer.scenes.newest?.parts.map((part) => part.key) ?? [];
    giveWork(panel, work, 'restored edits', keys);
  };
  const begin = async (key: string) => {
    const isOfTab = key === sceneBefore;
    sceneKey = key;
    kept.sceneOfTab = key;
    isWaiting = true;
    // Some windows have no storage, and so no work of another visit.
    const work = await kept.read(key).catch(() => undefined);
    const { scene, inspecting, leftScene } = store.getState();
    if (sceneKey !== key || !scene) return;
    hasRecord = work !== undefined;
    const edits = describeEdits(inspecting);
    // The edits may have come back with the scene.
    isWaiting = work !== undefined && work.edits !== '' && work.edits !== edits;
    if (!work) return;
    if (isOfTab && edits === '') {
      sceneBefore = null;
      await give(work);
      if (work.edits !== '') tell(`${scene.title} is as you left it, with ${work.edits}.`, 'Undo', 'undo');
    } else if (isWaiting && !leftScene) {
      const bringBack = () => {
        store.setState({ leftScene: null, notice: null });
        void give(work);
      };
      store.setState({ leftScene: { title: scene.title, bringBack } });
      tell(`${scene.title} had ${work.edits} when it was open last.`, 'Bring back', 'bring-back');
    }
  };
  const tell = (text: string, label: string, command: 'undo' | 'bring-back') =>
    store.setState({ notice: { text, offers: [{ label, command }] } });
  const follow = (state: ViewerState, before: ViewerState) => {
    const key = shownKey(panel);
    if (key !== null && key !== sceneKey) void begin(key);
    else if (KEPT.some((name) => state[name] !== before[name])) keepSoon();
  };
  const onLeave = (event: BeforeUnloadEvent) => {
    if (isUnkept && describeEdits(store.getState().inspecting) !== '') event.preventDefault();
  };
  follow(store.getState(), store.getState());
  const unsubscribe = store.subscribe(follow);
  addEventListener('beforeunload', onLeave);
  return () => {
    clearTimeout(timer);
    unsubscribe();
    removeEventListener('beforeunload', onLeave);
  };
}

/** Parts of the state after whose change there may be other work. */
const KEPT = ['inspecting', 'requested', 'scene', 'look', 'viewMode', 'accuracy', 'restedFrames'] as const;

/** Key of the scene's files; null while one is being opened. */
function shownKey({ store, viewer }: PanelProps): string | null {
  const { load, scene } = store.getState();
  const parts = viewer.scenes.newest?.parts;
  return load === null && scene && parts ? parts.map(({ contentKey }) => contentKey).join('\n') : null;
}

const EDITS = { database: 'websplatter edits', table: 'scenes' };
const TAB_KEY = 'websplatter scene';
/** Most scenes whose work is kept: that of a large one takes a megabyte. */
const MOST_SCENES = 20;

function inBrowser(): WorkStore {
  return {
    read: (key) =>
      inTable(EDITS, 'readonly', (table) => table.get(key) as IDBRequest<WorkRecord | undefined>),
    write: async (key, work) => {
      await inTable(EDITS, 'readwrite', (table) => table.put(work, key));
      await forgetOldest();
    },
    clear: (key) => inTable(EDITS, 'readwrite', (table) => table.delete(key)),
    get sceneOfTab() {
      try {
        return sessionStorage.getItem(TAB_KEY);
      } catch {
        // Some windows have no storage.
        return null;
      }
    },
    set sceneOfTab(key) {
      try {
        sessionStorage.setItem(TAB_KEY, key ?? '');
      } catch {
        // A reload then offers the edits.
      }
    },
  };
}

async function forgetOldest(): Promise<void> {
  const keys = await inTable(EDITS, 'readonly', (table) => table.getAllKeys());
  if (keys.length <= MOST_SCENES) return;
  const records = await inTable(EDITS, 'readonly', (table) => table.getAll() as IDBRequest<WorkRecord[]>);
  const oldest = keys.toSorted((a, b) => timeOf(a) - timeOf(b)).slice(0, keys.length - MOST_SCENES);
  for (const key of oldest) await inTable(EDITS, 'readwrite', (table) => table.delete(key));
  function timeOf(key: IDBValidKey): number {
    return records[keys.indexOf(key)].savedAtMs;
  }
}
