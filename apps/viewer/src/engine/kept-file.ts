import type { FileStore, KeptFile } from './file-memory.ts';

const DATABASE = 'websplatter';
const TABLE = 'files';
const KEY = 'last';

/** The last file in IndexedDB, which can hold handles. */
export const KEPT_FILE: FileStore = {
  read: () =>
    inTable('readonly', (table) => table.get(KEY) as IDBRequest<KeptFile | undefined>).then(
      (file) => file ?? null,
    ),
  write: (file) => inTable('readwrite', (table) => table.put(file, KEY)).then(() => {}),
  clear: () => inTable('readwrite', (table) => table.delete(KEY)).then(() => {}),
};

async function inTable<T>(
  mode: IDBTransactionMode,
  ask: (table: IDBObjectStore) => IDBRequest<T>,
): Promise<T> {
  const opening = indexedDB.open(DATABASE, 1);
  opening.onupgradeneeded = () => opening.result.createObjectStore(TABLE);
  const database = await answer(opening);
  try {
    return await answer(ask(database.transaction(TABLE, mode).objectStore(TABLE)));
  } finally {
    database.close();
  }
}

function answer<T>(request: IDBRequest<T>): Promise<T> {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}
