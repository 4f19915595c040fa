// Proves: metadata of any shape gives splats or a typed error.
import { expect, test } from 'vitest';
import { WebSplatterError } from '../../data/errors.ts';
import { Choices, fuzz } from '../../testing/fuzz.ts';
import { type AnyJson, glbOfText, gltfOf, splatAttributes } from '../../testing/gltf-fixture.ts';
import { chunkBytes, radOfTexts, radScene, randomNodes } from '../../testing/rad-fixture.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { checkDrawable } from '../../testing/read-damaged.ts';
import { droppedFiles, sogExample, sogFiles } from '../../testing/sog-fixture.ts';
import { wrongJson } from '../../testing/wrong-json.ts';
import { zipBytes } from '../../testing/zip-fixture.ts';
import { readSplats } from '../loading/read-splats.ts';
import type { SplatSource } from '../sources/splat-source.ts';

/** A scene whose JSON may be written wrong. */
interface Scene {
  readonly json: unknown;
  /** The source with this text as its JSON. */
  source(text: string): SplatSource;
}

/** Honest scenes of each kind. */
const SEEDS = process.env.WEBSPLATTER_FULL === '1' ? 60 : 20;

const encoded = (text: string) => new TextEncoder().encode(text);
const maybe = (choices: Choices, fields: object) => (choices.isTrue(0.5) ? fields : {});
const point = (choices: Choices) => Array.from({ length: 3 }, () => choices.below(100) / 10 - 5);

const SOGS = ([1, 2] as const).flatMap((version) =>
  ([0, 1, 2] as const).map((shDegree) =>
    sogExample({ version, count: 5, shDegree, paletteSize: 3 }, new Choices(shDegree)),
  ),
);

/** `meta.json` of either version: all fields, and some of those that may be there. */
function sogScene(choices: Choices): Scene {
  const { meta, images, rows } = choices.of(SOGS);
  const json = {
    ...meta,
    means: { ...meta.means, mins: point(choices), maxs: point(choices) },
    ...maybe(choices, { asset: { generator: 'a test' } }),
    ...maybe(choices, { model: choices.of(['default', 'antialiased', '2dgs']) }),
    ...maybe(choices, { antialias: choices.isTrue(0.5) }),
  };
  const isZipped = choices.isTrue(0.3);
  return {
    json,
    source: (text) => {
      const files = { ...sogFiles({ meta: {}, images, rows }), 'meta.json': encoded(text) };
      return isZipped ? zipBytes(files) : droppedFiles(files);
    },
  };
}

const PARTS = Array.from({ length: 5 }, (_, i) =>
  sogExample({ version: 2, count: 4 + i, shDegree: i === 0 ? 1 : 0, paletteSize: 3 }, new Choices(i)),
);

/** `lod-meta.json`: a tree of random shape, whose leaves share the splats of each file. */
function streamedScene(choices: Choices): Scene {
  const parts = PARTS.slice(0, 1 + choices.below(PARTS.length));
  const lodLevels = 1 + choices.below(3);
  const counts = new Array(lodLevels).fill(0);
  const bound = () => ({ min: point(choices), max: point(choices) });
  const leaves = Array.from({ length: 1 + choices.below(6) }, () => ({
    bound: bound(),
    lods: {} as Record<number, object>,
  }));
  for (const [file, { meta }] of parts.entries()) {
    const level = choices.below(lodLevels);
    counts[level] += meta.count;
    const free = leaves.filter(({ lods }) => !(level in lods));
    let offset = 0;
    while (offset < meta.count) {
      const leaf = free.pop() ?? { bound: bound(), lods: {} as Record<number, object> };
      if (!leaves.includes(leaf)) leaves.push(leaf);
      const count = free.length === 0 ? meta.count - offset : 1 + choices.below(meta.count - offset);
      leaf.lods[level] = { file, offset, count };
      offset += count;
    }
  }
  const nodes: object[] = leaves;
  while (nodes.length > 1)
    nodes.unshift({ bound: bound(), children: nodes.splice(choices.below(nodes.length - 1), 2) });
  const json = {
    ...maybe(choices, { version: 1, count: counts.reduce((sum, each) => sum + each, 0), counts }),
    ...maybe(choices, { asset: { generator: 'a test', chunkGaussians: 7, chunkExtent: 0.5 } }),
    lodLevels,
    ...maybe(choices, { environment: choices.of([null, 'env/meta.json']) }),
    filenames: parts.map((_, i) => `${i}/meta.json`),
    tree: nodes[0],
  };
  const files = parts.map((part, i) => sogFiles(part, `${i}/`));
  const environment = sogFiles(PARTS[1], 'env/');
  return {
    json,
    source: (text) => droppedFiles(Object.assign({ 'lod-meta.json': encoded(text) }, environment, ...files)),
  };
}

const GLTFS = ([0, 1] as const).flatMap((shDegree) =>
  [false, true].map((isInterleaved) =>
    gltfOf(splatAttributes(randomSplats({ count: 4, shDegree })), isInterleaved),
  ),
);
const SPLATTING = 'KHR_gaussian_splatting';

/** glTF: nodes in trees with all that may move them, splats and a mesh beside them. */
function gltfScene(choices: Choices): Scene {
  const { json: honest, binary } = choices.of(GLTFS);
  const json: AnyJson = structuredClone(honest);
  const [primitive] = json.meshes[0].primitives;
  Object.assign(
    primitive.extensions[SPLATTING],
    maybe(choices, { projection: 'perspective' }),
    maybe(choices, { sortingMethod: choices.of(['cameraDistance', 'zDepth']) }),
    maybe(choices, { extras: { websplatter: { sortBy: 'depth' } } }),
  );
  if (choices.isTrue(0.3)) json.meshes[0].primitives.push({ attributes: { POSITION: 0 }, mode: 4 });
  if (choices.isTrue(0.3)) json.meshes.push({ name: 'again', primitives: [primitive] });
  for (let i = choices.below(5); i > 0; i--) {
    const moved = choices.isTrue(0.3)
      ? { matrix: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, ...point(choices), 1] }
      : {
          ...maybe(choices, { translation: point(choices) }),
          ...maybe(choices, { rotation: [0, 0.6, 0, 0.8] }),
          ...maybe(choices, { scale: [2, 2, 2] }),
        };
    const parent = choices.of(json.nodes as AnyJson[]);
    parent.children = [...(parent.children ?? []), json.nodes.length];
    json.nodes.push({ ...moved, ...maybe(choices, { mesh: choices.below(json.meshes.length) }) });
  }
  Object.assign(
    json.asset,
    maybe(choices, { generator: 'a test', copyright: '', extras: { any: [1] } }),
    maybe(choices, { minVersion: '2.0' }),
  );
  Object.assign(json.accessors[0], { min: [-9, -9, -9], max: [9, 9, 9] });
  if (choices.isTrue(0.3)) json.extensionsRequired = [SPLATTING];
  if (choices.isTrue(0.2)) delete json.scenes;
  if (choices.isTrue(0.7)) return { json, source: (text) => glbOfText(text, binary) };
  json.buffers[0].uri = `data:application/octet-stream;base64,${Buffer.from(binary).toString('base64')}`;
  return { json, source: encoded };
}

/** .rad: the header of the scene, or of one of its chunks. */
function radSceneOf(choices: Choices): Scene {
  const isTree = choices.isTrue(0.7);
  const nodes = randomNodes(8 + choices.below(20), 1, isTree, choices.below(100));
  const palette = choices.isTrue(0.3) ? { paletteSize: 4 } : {};
  const { header, chunks } = radScene(nodes, { degree: 1, isTree, chunkSize: 8, ...palette });
  const encodedChunks = (changed?: number, text = '') =>
    chunks.map(({ json, payload }, i) => chunkBytes(i === changed ? text : JSON.stringify(json), payload));
  if (choices.isTrue(0.5))
    return {
      json: { ...header, ...maybe(choices, { comment: 'a test', splatEncoding: { rgbMin: 0 } }) },
      source: (text) => radOfTexts(text, encodedChunks()),
    };
  const changed = choices.below(chunks.length);
  return {
    json: chunks[changed].json,
    source: (text) => {
      const parts = encodedChunks(changed, text);
      let end = 0;
      const places = parts.map(({ length }) => {
        const offset = end;
        end += length;
        return { offset, bytes: length };
      });
      return radOfTexts(JSON.stringify({ ...header, chunks: places }), parts);
    },
  };
}

const SCENES = { 'meta.json': sogScene, 'lod-meta.json': streamedScene, glTF: gltfScene, '.rad': radSceneOf };
/** Of one processor, ms, for a text of this length: parsing alone takes a share of both. */
const mostTimeMs = (characters: number) => 250 + characters / 5000;

/** Reads a source; throws unless it gives drawable splats, or a typed error that can be shown. */
async function outcomeOf(source: SplatSource): Promise<string> {
  try {
    checkDrawable(await readSplats(source));
    return 'splats';
  } catch (error) {
    if (!(error instanceof WebSplatterError)) throw error;
    const { message } = error;
    if (message.length > 1200 || /[\p{Cc}\p{Bidi_C}]|secret/u.test(message))
      throw new Error(`The message cannot be shown: ${JSON.stringify(message).slice(0, 2000)}`);
    return error.code;
  }
}

test('metadata that its grammar allows is read', { tags: 'deeper' }, async () => {
  for (let seed = 1; seed <= SEEDS; seed++) {
    for (const [title, sceneOf] of Object.entries(SCENES)) {
      const { json, source } = sceneOf(new Choices(seed));
      expect(await outcomeOf(source(JSON.stringify(json))), `${title}, seed ${seed}`).toBe('splats');
    }
  }
});

/**
 * @fault Files: metadata of SOG, streamed SOG or glTF with wrong, deep, wide or missing values at any key
 * @consequence splats or a `WebSplatterError`, within 0.4 s of CPU time
 */
test('metadata with wrong, deep, wide and missing values at any key gives splats or a typed error, soon', {
  tags: 'deeper',
  timeout: 3_600_000,
}, async () => {
  const found: Record<string, Record<string, number>> = {};
  let [slowestMs, slowest] = [0, ''];
  await fuzz({ few: 300, many: 5_000 }, async (choices) => {
    const [title, sceneOf] = choices.of(Object.entries(SCENES));
    const { json, source } = sceneOf(choices);
    const text = wrongJson(json, choices.of([0.005, 0.02, 0.05, 0.2]), choices);
    const mostMs = mostTimeMs(text.length);
    let [timeMs, outcome] = [Number.POSITIVE_INFINITY, ''];
    // Other threads of the process may use the processor, too.
    for (let i = 0; i < 3 && timeMs > mostMs; i++) {
      const read = source(text);
      const start = process.cpuUsage();
      outcome = await outcomeOf(read);
      const { user, system } = process.cpuUsage(start);
      timeMs = Math.min(timeMs, (user + system) / 1000);
    }
    if (timeMs > mostMs) throw new Error(`${title} of ${text.length} characters took ${timeMs} ms`);
    if (timeMs > slowestMs) [slowestMs, slowest] = [timeMs, `${title} of ${text.length} characters`];
    found[title] ??= {};
    found[title][outcome] = (found[title][outcome] ?? 0) + 1;
  });
  console.info(`${JSON.stringify(found)}, slowest ${slowestMs.toFixed(0)} ms (${slowest})`);
  for (const title of Object.keys(SCENES))
    expect(Object.keys(found[title])).toEqual(expect.arrayContaining(['splats', 'bad-header', 'damaged']));
});
