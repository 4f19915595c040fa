/** A table of its own in IndexedDB, which can store handles and typed arrays. */
export interface BrowserTable {
  readonly database: string;
  readonly table: string;
}

/** Asks a table, which is made at the first call. Rejects where the browser gives no storage. */
export async function inTable<T>(
  { database: name, table }: BrowserTable,
  mode: IDBTransactionMode,
  ask: (table: IDBObjectStore) => IDBRequest<T>,
): Promise<T> {
  const opening = indexedDB.open(name, 1);
  opening.onupgradeneeded = () => opening.result.createObjectStore(table);
  const database = await answer(opening);
  try {
    return await answer(ask(database.transaction(table, mode).objectStore(table)));
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
