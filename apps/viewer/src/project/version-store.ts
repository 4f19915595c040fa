import { inTable } from '../engine/keep/browser-table.ts';
import type { KeptWork } from './kept-work.ts';

/** A version at a time: it may be changed later. */
export type VersionMoment = readonly [id: string, savedAtMs: number];

/** Work as the browser keeps it. */
export interface WorkRecord extends KeptWork {
  /** As `describeEdits`; empty if nothing but the view differs from the file. */
  readonly edits: string;
  readonly savedAtMs: number;
  /** Versions that were brought back into this one, which need not be offered. Records of earlier viewers have none. */
  readonly includes?: readonly VersionMoment[];
}

/** The work of one tab on a scene, from when the scene was opened. */
export interface Version {
  /** Unique. Empty for a record of an earlier viewer, which kept one for each scene. */
  readonly id: string;
  readonly work: WorkRecord;
  /** Whether a tab goes on with it, maybe this one. */
  readonly isOpen: boolean;
}

/** Place of a version: the contents of its scene's files, and its `id`. */
export interface VersionPlace {
  readonly key: string;
  readonly id: string;
}

/** Where versions are kept, each in a record of its own: tabs on the same files must not replace each other's. */
export interface VersionStore {
  /** All versions of a scene. */
  read(key: string): Promise<readonly Version[]>;
  /** Rejects if there is no room. */
  write(place: VersionPlace, work: WorkRecord): Promise<unknown>;
  clear(place: VersionPlace): Promise<unknown>;
  /** The version that this tab showed before it was loaded again, and that it shows from now on. */
  versionOfTab: VersionPlace | null;
  /** Has a version be open until the returned function is called, or the page ends in whatever way. */
  hold(id: string): () => void;
  /** Tells other tabs that versions of a scene have changed. */
  tell(key: string): void;
  /** Calls back with the scene that another tab tells of; returns a function that stops this. */
  watch(onChange: (key: string) => void): () => void;
}

const EDITS = { database: 'websplatter edits', table: 'scenes' };
const TAB_KEY = 'websplatter scene';
const LOCK = 'websplatter edits ';
/** Most versions that are kept, of all scenes: that of a large one takes a megabyte. */
const MOST_VERSIONS = 20;

/** Versions in this browser. Copies of a tab begin with the session storage of the original, and know by its lock that it is still open. */
export function browserVersions(): VersionStore {
  const channel = new BroadcastChannel(EDITS.database);
  return {
    read: async (key) => {
      const [places, open] = await Promise.all([allPlaces(), openIds()]);
      const ofScene = places.filter((place) => placeOf(place).key === key);
      const works = await Promise.all(
        ofScene.map((place) =>
          inTable(EDITS, 'readonly', (table) => table.get(place) as IDBRequest<WorkRecord | undefined>),
        ),
      );
      return works.flatMap((work, i) => {
        const { id } = placeOf(ofScene[i]);
        return work ? [{ id, work, isOpen: open.has(id) }] : [];
      });
    },
    write: async (place, work) => {
      await inTable(EDITS, 'readwrite', (table) => table.put(work, recordKey(place)));
      // The work is kept, whatever becomes of older ones.
      await forgetOldest().catch(() => {});
    },
    clear: (place) => inTable(EDITS, 'readwrite', (table) => table.delete(recordKey(place))),
    get versionOfTab() {
      try {
        return placeIn(sessionStorage.getItem(TAB_KEY));
      } catch {
        // Some windows have no storage.
        return null;
      }
    },
    set versionOfTab(place) {
      try {
        sessionStorage.setItem(TAB_KEY, JSON.stringify(place));
      } catch {
        // A reload then offers the edits.
      }
    },
    hold: (id) => {
      let release = () => {};
      const released = new Promise<void>((resolve) => {
        release = resolve;
      });
      // Sandboxed frames have no locks, and no storage for other tabs to read.
      void navigator.locks?.request(LOCK + id, () => released).catch(() => {});
      return release;
    },
    tell: (key) => channel.postMessage(key),
    watch: (onChange) => {
      channel.onmessage = ({ data }) => onChange(data);
      return () => channel.close();
    },
  };
}

function recordKey({ key, id }: VersionPlace): IDBValidKey {
  return id === '' ? key : [key, id];
}

function placeOf(record: IDBValidKey): VersionPlace {
  const [key, id = ''] = Array.isArray(record) ? record.map(String) : [String(record)];
  return { key, id };
}

/** An earlier viewer wrote the scene alone. */
function placeIn(text: string | null): VersionPlace | null {
  if (!text) return null;
  try {
    const { key, id } = Object(JSON.parse(text));
    return typeof key === 'string' && typeof id === 'string' ? { key, id } : null;
  } catch {
    // Not JSON: the scene alone, as it was written once.
    return { key: text, id: '' };
  }
}

function allPlaces(): Promise<IDBValidKey[]> {
  return inTable(EDITS, 'readonly', (table) => table.getAllKeys());
}

/** Versions that some tab goes on with. */
async function openIds(): Promise<ReadonlySet<string>> {
  // Without an answer, only the age of versions decides which are forgotten.
  const { held = [] } = (await navigator.locks?.query().catch((): LockManagerSnapshot => ({}))) ?? {};
  return new Set(held.flatMap(({ name }) => (name?.startsWith(LOCK) ? [name.slice(LOCK.length)] : [])));
}

/** Forgets versions without edits first, then the oldest, and none that a tab goes on with. */
async function forgetOldest(): Promise<void> {
  const places = await allPlaces();
  if (places.length <= MOST_VERSIONS) return;
  const [works, open] = await Promise.all([
    inTable(EDITS, 'readonly', (table) => table.getAll() as IDBRequest<WorkRecord[]>),
    openIds(),
  ]);
  const closed = places
    .map((place, i) => ({ place, work: works[i] }))
    .filter(({ place }) => !open.has(placeOf(place).id));
  const rank = ({ work: { edits, savedAtMs } }: (typeof closed)[number]) => (edits === '' ? 0 : savedAtMs);
  closed.sort((a, b) => rank(a) - rank(b));
  for (const { place } of closed.slice(0, places.length - MOST_VERSIONS))
    await inTable(EDITS, 'readwrite', (table) => table.delete(place));
}
