import {
  type GpuSplatFaults,
  type GpuSplats,
  type GpuSplatsOptions,
  InvalidArgumentError,
  type SplatBuffer,
  type SplatCloud,
  type SplatEngine,
  SplatSourceError,
  shown,
} from '@websplatter/core';
import { flushEdits } from '@websplatter/core/own-data';
import { Box3, type BufferAttribute, REVISION, type WebGPURenderer } from 'three/webgpu';
import type { DataEdits } from '../cloud/data-edits.ts';
import { ChangeAnnouncer } from '../cloud/shown-data.ts';
import { SplatData } from '../cloud/splat-data.ts';
import { ThreeInternalsError } from '../errors.ts';
import { type Backend, hasWebGpuBackend } from '../renderer/three-bridge.ts';

/**
 * Values of splats on the GPU: a storage attribute of three's, the node of one, such as
 * `instancedArray(count, 'vec3')`, or a buffer of `engine.device`. An attribute may have more values
 * per splat than are needed; the first are read.
 */
export type GpuColumn = BufferAttribute | { readonly value: BufferAttribute } | SplatBuffer;

const COLUMNS = ['positions', 'scales', 'colors', 'rotations', 'opacities'] as const;

/** As the options of `engine.addGpuSplats`, with three's attributes. */
export interface MakeGpuSplatsOptions extends Omit<GpuSplatsOptions, 'count' | (typeof COLUMNS)[number]> {
  /** Number of splats. Default: that of the attribute `positions`. */
  readonly count?: number;
  /** 3 values per splat: centre x, y, z. */
  readonly positions: GpuColumn;
  /** 3 values per splat: standard deviations along the local axes. */
  readonly scales: GpuColumn;
  /** 3 values per splat: r, g, b, sRGB-encoded, 0…1. */
  readonly colors: GpuColumn;
  /** 4 values per splat: a quaternion x, y, z, w. Default: no turn. */
  readonly rotations?: GpuColumn;
  /** 1 value per splat: 0…1. Default: 1. */
  readonly opacities?: GpuColumn;
}

/**
 * Makes data, for `<Splats src={data}>` or a SplatCloudObject, of splats that compute shaders write:
 * three's own, by TSL, or those of other code on the same device. Call `changed()` after each
 * dispatch. Nothing passes through the CPU.
 *
 * @param renderer whose attributes they are. Other renderers do not show them.
 * @throws InvalidArgumentError naming the option that is wrong. Objects report errors of the buffers
 *   themselves, as `engine.addGpuSplats` does.
 * @example
 * const [positions, scales, colors] = [0, 0, 0].map(() => instancedArray(100_000, 'vec3'));
 * const bounds = { min: [-1, -1, -1], max: [1, 1, 1] } as const;
 * const data = makeGpuSplats(renderer, { positions, scales, colors, bounds });
 * scene.add(new SplatCloudObject(data));
 * renderer.setAnimationLoop(() => {
 *   renderer.compute(simulation); // a TSL function of yours
 *   data.changed();
 *   renderer.render(scene, camera);
 * });
 */
export function makeGpuSplats(renderer: WebGPURenderer, options: MakeGpuSplatsOptions): GpuSplatData {
  if (typeof options !== 'object' || options === null)
    throw new InvalidArgumentError('options', `options is ${shown(options)}; it must be an object.`);
  for (const name of COLUMNS) {
    const column = options[name];
    if (column === undefined && (name === 'rotations' || name === 'opacities')) continue;
    if (!isColumn(column)) {
      const message = `${name} is ${shown(column)}; it must be a storage attribute, the node of one, or { buffer }.`;
      throw new InvalidArgumentError(name, message);
    }
  }
  const { positions } = options;
  const count = options.count ?? ('buffer' in positions ? undefined : attributeOf(positions).count);
  if (count === undefined)
    throw new InvalidArgumentError(
      'count',
      'count is missing; give it beside buffers that are no attributes.',
    );
  return new GpuSplatData(renderer, { ...options, count });
}

/**
 * Splats that compute shaders write, made by `makeGpuSplats`. `bounds` are those that were given; else
 * they are so large that no camera leaves them. They are drawn in full detail; edits, rays and further
 * renderers are refused.
 */
export class GpuSplatData extends SplatData {
  readonly #made = new Set<GpuSplats>();
  readonly #source = new GpuSource();
  readonly #announcer: ChangeAnnouncer;

  /** @internal Use `makeGpuSplats`. */
  constructor(renderer: WebGPURenderer, options: MakeGpuSplatsOptions & { readonly count: number }) {
    const { name = 'splats', count, bounds = EVERYWHERE } = options;
    const make = (engine: SplatEngine, signal: AbortSignal) => this.#make(engine, signal, renderer, options);
    super({ count, bounds, robustBounds: bounds, make }, name);
    this.edits = this.#source;
    this.#announcer = new ChangeAnnouncer(this);
  }

  /**
   * Has the buffers packed again before the next frame, and requests it. Call it after the dispatch
   * that changes them.
   *
   * @throws DestroyedError if a buffer was destroyed.
   */
  changed(): void {
    this.#source.version++;
    for (const splats of this.#live()) splats.changed();
    this.#announcer.announce();
  }

  /**
   * Counts the splats that are not drawn because of their values: see `GpuSplats.countFaults`. Waits
   * for the GPU. Empty before an object is drawn.
   *
   * @throws DestroyedError, GpuLimitError as `GpuSplats.countFaults` does.
   */
  async countFaults(): Promise<GpuSplatFaults> {
    const [splats] = this.#live();
    return splats ? splats.countFaults() : {};
  }

  /**
   * Reads the bounds of the drawn centres back, in the cloud's own space; null before an object is
   * drawn, and without splats. Waits for the GPU.
   *
   * @throws DestroyedError, GpuLimitError as `GpuSplats.readBounds` does.
   */
  async readBounds(): Promise<Box3 | null> {
    const [splats] = this.#live();
    const bounds = await splats?.readBounds();
    return bounds ? new Box3().setFromArray([...bounds.min, ...bounds.max]) : null;
  }

  /** @throws SplatSourceError always: rays need splats that last. */
  override prepareRays(): Promise<void> {
    return Promise.reject(
      new SplatSourceError(
        this.name,
        'the GPU makes its splats anew, so rays cannot hit them: find them by pickAt, which reads the picture.',
      ),
    );
  }

  /** @internal */
  override raycast(): void {}

  #live(): GpuSplats[] {
    return [...this.#made].filter(({ cloud }) => !cloud.isDestroyed);
  }

  async #make(
    engine: SplatEngine,
    signal: AbortSignal,
    renderer: WebGPURenderer,
    { name, count, bounds, ...options }: MakeGpuSplatsOptions & { readonly count: number },
  ): Promise<SplatCloud> {
    const columns = COLUMNS.flatMap((column) => {
      const given = options[column];
      return given ? [[column, bufferOf(renderer, given)] as const] : [];
    });
    const splats = await engine.addGpuSplats({
      name,
      count,
      bounds,
      ...(Object.fromEntries(columns) as Pick<GpuSplatsOptions, (typeof COLUMNS)[number]>),
    });
    if (signal.aborted) splats.cloud.destroy();
    signal.throwIfAborted();
    for (const gone of this.#made) if (gone.cloud.isDestroyed) this.#made.delete(gone);
    this.#made.add(splats);
    // The buffers may have changed since they were packed.
    this.changed();
    return splats.cloud;
  }
}

/** Bounds of clouds without bounds of their own, as core has them. */
const EVERYWHERE = { min: [-1e18, -1e18, -1e18], max: [1e18, 1e18, 1e18] } as const;

/** What changes splats that the GPU makes: its version, and their last state for readers. */
class GpuSource implements DataEdits {
  readonly what = 'is made by the GPU';
  version = 0;
  readonly uneditedBounds = new Box3();

  async follow(): Promise<void> {}

  flush(cloud: SplatCloud): void {
    flushEdits(cloud);
  }

  move(): void {}
}

function isColumn(column: unknown): column is GpuColumn {
  if (typeof column !== 'object' || column === null) return false;
  if ('buffer' in column) return true;
  return isAttribute(column) || ('value' in column && isAttribute(column.value));
}

function isAttribute(value: unknown): value is BufferAttribute {
  return (value as Partial<BufferAttribute> | null)?.isBufferAttribute === true;
}

function attributeOf(column: Exclude<GpuColumn, SplatBuffer>): BufferAttribute {
  return isAttribute(column) ? column : column.value;
}

/** The parts of three's backend that make a storage attribute's buffer. */
interface AttributeBackend extends Backend {
  createStorageAttribute(attribute: BufferAttribute): void;
}

/** @throws InvalidArgumentError without WebGPU, ThreeInternalsError if three has changed. */
function bufferOf(renderer: WebGPURenderer, column: GpuColumn): SplatBuffer {
  if ('buffer' in column) return column;
  if (!hasWebGpuBackend(renderer))
    throw new InvalidArgumentError('renderer', 'renderer draws without WebGPU, which attributes need.');
  const attribute = attributeOf(column);
  const backend = renderer.backend as unknown as AttributeBackend;
  const bufferNow = () => (backend.get(attribute) as { readonly buffer?: GPUBuffer }).buffer;
  // three makes it with the first dispatch, and finds this one then.
  if (!bufferNow()) backend.createStorageAttribute?.(attribute);
  const buffer = bufferNow();
  if (!buffer) throw new ThreeInternalsError('renderer.backend.get(attribute).buffer', REVISION);
  // three pads vec3 to 16 bytes.
  return { buffer, strideBytes: 4 * Math.floor(buffer.size / 4 / attribute.count) };
}
