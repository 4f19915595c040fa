import { inTable } from './browser-table.ts';
import type { FileStore, KeptFile } from './file-memory.ts';

const FILES = { database: 'websplatter', table: 'files' };
const LAST = 'last';
const RECENT = 'recent';
/** As many as are seen at once in a panel. */
const MOST_RECENT = 8;

/** Keeps files in IndexedDB, which can store handles. */
export const KEPT_FILES: FileStore = {
  read: async () => (await get<KeptFile>(LAST)) ?? null,
  readRecent: recentFiles,
  write: async (file) => {
    await put(file, LAST);
    await put([file, ...(await othersThan(file.name))].slice(0, MOST_RECENT), RECENT);
  },
  clear: async () => {
    const last = await get<KeptFile>(LAST);
    if (!last) return;
    await put(await othersThan(last.name), RECENT);
    await inTable(FILES, 'readwrite', (table) => table.delete(LAST));
  },
};

async function recentFiles(): Promise<readonly KeptFile[]> {
  return (await get<readonly KeptFile[]>(RECENT)) ?? [];
}

async function othersThan(name: string): Promise<readonly KeptFile[]> {
  return (await recentFiles()).filter((each) => each.name !== name);
}

function get<T>(key: string): Promise<T | undefined> {
  return inTable(FILES, 'readonly', (table) => table.get(key) as IDBRequest<T | undefined>);
}

async function put(value: unknown, key: string): Promise<void> {
  await inTable(FILES, 'readwrite', (table) => table.put(value, key));
}
