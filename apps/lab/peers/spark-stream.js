import { sparkScene } from './spark-scene.js';

/** Numbers of `SparkRenderer` that an address may set. */
const SETTINGS = ['lodSplatCount', 'maxPagedSplats', 'lodRenderScale'];

/**
 * Spark with a `.rad` in pages. Spark does not say when everything is there: nothing is fetched,
 * uploaded, chosen or sorted then.
 *
 * @type {import('../src/peers/adapter.ts').LoadPeer}
 */
export default async function loadSpark({ canvas, url, fileName, options }) {
  const given = SETTINGS.filter((name) => options.has(name));
  const settings = Object.fromEntries(given.map((name) => [name, Number(options.get(name))]));
  const { spark, mesh, isOrdered, peer } = sparkScene(canvas, settings, { url, fileName, paged: true });
  await mesh.initialized;
  return {
    note: given.map((name) => `${name} ${settings[name]}`).join(', '),
    ...peer,
    isComplete: () => {
      const { pager } = spark;
      if (!pager) return false;
      const { fetchers, fetched, newUploads, readyUploads, lodTreeUpdates } = pager;
      const waiting = [fetchers, fetched, newUploads, readyUploads, lodTreeUpdates, spark.lodUpdates];
      const isChosen = !spark.lodDirty && spark.currentLod === spark.lastLod;
      return isChosen && isOrdered() && waiting.every(({ length }) => length === 0);
    },
  };
}
