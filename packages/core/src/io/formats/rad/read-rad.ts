import { SplatFileError } from '../../../data/errors.ts';
import { readExactly } from '../../sources/read-all.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import type { ReadFormat } from '../read-format.ts';
import { ReadProgress } from '../rows/progress.ts';
import { checkCount } from '../rows/splat-counts.ts';
import { SplatSetBuilder } from '../rows/splat-set-builder.ts';
import { SceneFileReader } from '../scene-file-reader.ts';
import { FinestReader } from './finest-reader.ts';
import { RadChunk } from './rad-chunk.ts';
import { readRadHeader } from './rad-header.ts';

/**
 * Reads the finest level of a `.rad`, version 1: the nodes without children. A splat's row is its
 * node's index in the scene.
 *
 * A file has 'RAD0', the length of its JSON, the JSON, and chunks of nodes or the names of files
 * with one chunk each. A chunk has 'RADC', the length of its JSON, the JSON, the length of the
 * rest, and columns. Each column is compressed separately as raw deflate, which the JSON calls
 * `gz`. Parts are padded to 8 bytes.
 *
 * Values are decoded as Spark does, except opacities above 1: they are clamped, since only rounding
 * produces them in nodes without children.
 *
 * Rejects with `SplatFileError`: 'bad-property' for encodings outside of version 1,
 * 'unknown-format' for other versions; 'bad-header', 'damaged', 'truncated', 'missing-part',
 * 'too-large', 'empty'; and as `openPart`.
 */
export const read: ReadFormat = async (input, options) => {
  const { name: file } = input;
  const { shPrecision, onPiece, maxSplats, maxBytes } = options;
  const header = await readRadHeader(file, (byteCount, what) => readExactly(input, byteCount, what));
  const { count, shDegree, isTree, chunks } = header;
  if (!isTree) checkCount(count, file, maxSplats);
  const progress = new ReadProgress(input, options.onProgress);
  const parts = new SceneFileReader(input, options, progress);
  const partCount = chunks.filter(({ path }) => path !== null).length;
  if (partCount > 0) parts.expect(partCount);
  const builder = new SplatSetBuilder({
    ...{ file, shDegree, shPrecision, onPiece, fileFacts: { format: 'rad' } },
    widePositions: false,
    promisedCount: count,
    isLocal: false,
  });
  const leaves = new FinestReader(header, builder, file, maxSplats, async () => {
    progress.report(builder.count);
    await builder.handOn();
    await input.reader.pause();
  });
  let packedBytes = 0;
  let unpackedBytes = 0;
  const checkUnpacked = (byteCount: number) => {
    unpackedBytes += byteCount;
    const limit = unpackedLimit({ maxBytes }, { totalBytes: packedBytes });
    if (unpackedBytes <= limit) return;
    const message = `it unpacks to ${unpackedBytes} bytes or more, and ${limit} are the limit. Pass a larger maxBytes if that is right.`;
    throw new SplatFileError('too-large', file, message);
  };
  for (const [i, place] of chunks.entries()) {
    const what = place.path ?? `chunk ${i}`;
    const bytes =
      place.path === null ? await readExactly(input, place.bytes, what) : await parts.read(place.path);
    packedBytes += bytes.length;
    const chunk = new RadChunk(bytes, place, `${file}, ${what}`, checkUnpacked);
    await leaves.read(chunk, place.base, place.count);
    progress.report(builder.count);
  }
  leaves.finish();
  progress.finish(builder.count);
  return builder.finish();
};
