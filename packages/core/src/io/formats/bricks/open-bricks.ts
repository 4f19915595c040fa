import type { Brick, BrickAddress, BrickCell, BrickScene } from '../../../data/bricks/brick.ts';
import { BrickShape } from '../../../data/bricks/brick-shape.ts';
import { SplatFileError } from '../../../data/errors.ts';
import { wrongArgument } from '../../../data/given.ts';
import { SceneWorkers } from '../../loading/scene-workers.ts';
import { fromPostedError } from '../../posted-error.ts';
import { AdjacentReads } from '../../sources/adjacent-reads.ts';
import { FewRequests } from '../../sources/few-requests.ts';
import type { KnownSource } from '../../sources/known-source.ts';
import { openRanges } from '../../sources/open-ranges.ts';
import type { ReadOptions } from '../../sources/splat-source.ts';
import { checkNested } from './brick-header.ts';
import { brickHeaderBytes, FILE_HEADER_BYTES, mostBrickBytes } from './bricks-layout.ts';
import type { BrickOutcome } from './fetch-bricks.ts';
import { readFileHeader } from './file-header.ts';

/** Bytes of the first request; for large scenes, they cover the header and the root brick. */
const FIRST_BYTES = 1 << 17;

/**
 * Opens a scene in bricks for streaming. The header is read now, each brick on request. Workers of
 * the scene decode bricks, and fetch them from servers; the page does, if none can start.
 *
 * Rejects with SplatSourceError if the file cannot be fetched, or not in byte ranges. Rejects with
 * SplatFileError if the file has another format or is damaged. Rejects with InvalidArgumentError if
 * the source is a stream or invalid, and with the signal's reason.
 */
export async function openBricks(
  source: KnownSource,
  options: Pick<ReadOptions, 'signal' | 'request'> = {},
): Promise<BrickScene> {
  const workers = new SceneWorkers(source.name);
  try {
    return await openWith(workers, source, options);
  } catch (error) {
    workers.end();
    throw error;
  }
}

async function openWith(
  workers: SceneWorkers,
  source: KnownSource,
  options: Pick<ReadOptions, 'signal' | 'request'>,
): Promise<BrickScene> {
  const requests = new FewRequests();
  const ranges = await openRanges(source, FIRST_BYTES, options, requests);
  const { name, totalBytes, remote } = ranges;
  const first = await ranges.read(0, FILE_HEADER_BYTES, options.signal);
  const header = readFileHeader(first, name);
  const { splatCount, shDegree } = header;
  const shape = new BrickShape(splatCount);
  /** The parent cell of each brick address handed out: the brick must lie within its bounds. */
  const above = new WeakMap<BrickAddress, BrickCell>();

  const check = ({ number, offset, bytes }: BrickAddress) => {
    const { level, first: firstCell, end } = shape.cellsOf(number);
    const least = brickHeaderBytes(level, end - firstCell);
    const most = mostBrickBytes(level, end - firstCell, shDegree);
    const place = { byte: offset };
    if (!(bytes >= least && bytes <= most)) {
      const message = `brick ${number} has ${bytes} bytes, not ${least} to ${most}. Download or export it again.`;
      throw new SplatFileError('damaged', name, message, place);
    }
    if (totalBytes !== undefined && offset + bytes > totalBytes) {
      const message = `brick ${number} ends at byte ${offset + bytes}, the file at ${totalBytes}. Download or export it again.`;
      throw new SplatFileError('truncated', name, message, place);
    }
  };

  const file = { name, splatCount, shDegree };

  /** Reads a brick here; a worker decodes it. */
  const decode = async (address: BrickAddress, signal?: AbortSignal): Promise<Brick> => {
    // Copied, because the bytes may be a view of a buffer that is still in use.
    const bytes = (await ranges.read(address.offset, address.bytes, signal)).slice();
    return workers.call('decodeBrick', { file, address, bytes }, { transfer: [bytes.buffer], signal });
  };

  /** Reads bricks in a worker, because reading responses would take much of the page's time. */
  const fetches = new AdjacentReads<BrickAddress, Brick>((run, signal) => {
    const onProgress = (outcome: BrickOutcome) => {
      const { resolve, reject } = run[outcome.index];
      if ('brick' in outcome) resolve(outcome.brick);
      else reject(fromPostedError(outcome.error));
    };
    const input = { file, remote: remote!, addresses: run.map(({ part }) => part) };
    return requests.run(() => workers.call('fetchBricks', input, { signal, onProgress }), signal);
  });

  const read = async (address: BrickAddress, signal?: AbortSignal): Promise<Brick> => {
    signal?.throwIfAborted();
    const { number } = address;
    if (!(Number.isInteger(number) && number >= 0 && number < shape.brickCount))
      throw wrongArgument('address.number', number, `from 0 to ${shape.brickCount - 1}`, name);
    check(address);
    const isHeld = !remote || address.offset < remote.heldBytes;
    const brick = await (isHeld ? decode(address, signal) : fetches.read(address, signal));
    const parent = above.get(address);
    if (parent) checkNested(brick, parent, address, name);
    for (const cell of brick.cells) {
      if (!cell.child) continue;
      check(cell.child);
      above.set(cell.child, cell);
    }
    return brick;
  };
  const end = () => workers.end();
  check(header.root);
  const { isAntialiased, origin, bounds, robustBounds, root } = header;
  return {
    ...{
      name,
      splatCount,
      brickCount: shape.brickCount,
      shDegree,
      origin,
      bounds,
      robustBounds,
      root,
      read,
      end,
    },
    ...(isAntialiased !== undefined && { isAntialiased }),
  };
}
