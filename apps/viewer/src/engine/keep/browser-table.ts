/** A table of its own in IndexedDB, which can store handles and typed arrays. */
export interface BrowserTable {
  readonly database: string;
  readonly table: string;
}

/**
 * Asks a table, which is made at the first call. Resolves once the answer is stored, for browsers may
 * find that there is no room after a request has succeeded. Rejects where the browser gives no storage.
 */
export async function inTable<T>(
  { database: name, table }: BrowserTable,
  mode: IDBTransactionMode,
  ask: (table: IDBObjectStore) => IDBRequest<T>,
): Promise<T> {
  const opening = indexedDB.open(name, 1);
  opening.onupgradeneeded = () => opening.result.createObjectStore(table);
  const database = await answer(opening);
  try {
    const transaction = database.transaction(table, mode);
    const [found] = await Promise.all([answer(ask(transaction.objectStore(table))), end(transaction)]);
    return found;
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

function end(transaction: IDBTransaction): Promise<void> {
  return new Promise((resolve, reject) => {
    transaction.oncomplete = () => resolve();
    transaction.onabort = () => reject(transaction.error);
  });
}
