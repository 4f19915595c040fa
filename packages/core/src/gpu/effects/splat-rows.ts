import { NO_ROW } from '../../data/bricks/leaf-scene.ts';
import type { GpuMemory } from '../gpu-memory.ts';
import type { EffectRows, RowCloud, RowPage, RowTextures } from './effect.ts';
import { rowsOf } from './effect-set.ts';

/** Binding of the rows of the page's splats, in stages whose hooks take `row`. */
const ROWS_BINDING = 21;
/**
 * Most texels of a texture's line, and most lines: every device allows as many. Enough for 67 million
 * splats of a page; further ones have no row. A texture, because a stage may have no more than eight
 * storage buffers.
 */
const LINE_TEXELS = 8192;

/** Rows of blobs and of previews, which have none. */
const NO_ROWS = /* @__PURE__ */ Uint32Array.of(NO_ROW);

/**
 * Lets an effect's functions for splats and colours take `row: u32`, the row of the splat in its
 * cloud's file, as `pick` returns it: `rows: splatRows` of `defineEffect`. 4294967295 for splats without
 * a row: merged ones, those of coarser levels of streamed SOG and .rad, and previews of a load.
 *
 * Costs 4 bytes of GPU memory per splat of the cloud and view.
 *
 * @example
 * const dots = defineEffect<{ values: GPUBuffer }>({
 *   name: 'dots', label: 'Dots', about: 'Makes each splat as bright as the value of its row.',
 *   hooks: { color: 'dotColor' },
 *   rows: splatRows,
 *   resources: effectResources({ values: 'array<f32>' }, ({ values }) => ({ values })),
 *   wgsl: `import package::lib::packing::Splat;
 * import parameters::dotsValues;
 * fn dotColor(color: vec3f, splat: Splat, index: u32, centerView: vec3f, row: u32) -> vec3f {
 *   if (row >= arrayLength(&dotsValues)) { return color; }
 *   return color * dotsValues[row];
 * }`,
 *   calledFor: () => 'each row has a value',
 * });
 */
export const splatRows: EffectRows = {
  wgsl: () => `@group(0) @binding(${ROWS_BINDING}) var splatRows: texture_2d<u32>;
fn rowOf(splatIndex: u32) -> u32 {
  let texel = vec2u(splatIndex % ${LINE_TEXELS}u, splatIndex / ${LINE_TEXELS}u);
  if (any(texel >= textureDimensions(splatRows))) { return ${NO_ROW}u; }
  return textureLoad(splatRows, texel, 0).x;
}`,
  texturesIn: (memory, queue) => new PageTextures(memory, queue),
};

/** Rows of one page on the GPU. */
interface HeldRows {
  readonly cloud: RowCloud['cloud'];
  readonly page: RowPage;
  readonly texture: GPUTexture;
  readonly view: GPUTextureView;
  /** Version of the splats whose rows it holds; null before the first write. */
  written: number | null;
}

/** One texture per page of a cloud, whichever batches of instances draw it. */
class PageTextures implements RowTextures {
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;
  /** By the geometry of a page: pages whose geometry stays keep their texture. */
  readonly #held = new Map<GPUBuffer, HeldRows>();
  /** By page of the frame; null where no effect takes rows. */
  #pages: readonly (RowPage | null)[] = [];

  constructor(memory: GpuMemory, queue: GPUQueue) {
    this.#memory = memory;
    this.#queue = queue;
  }

  fit(clouds: readonly RowCloud[], pages: readonly RowPage[]): void {
    this.#pages = pages.map((page) => (rowsOf(clouds[page.cloudIndex].effects) ? page : null));
    const needed = new Map<GPUBuffer, RowPage>();
    for (const page of this.#pages) if (page) needed.set(page.geometry, page);
    for (const [geometry, { cloud, texture }] of this.#held) {
      const page = needed.get(geometry);
      // The last preview of a load has the geometry of the cloud, and no rows.
      if (page && clouds[page.cloudIndex].cloud === cloud) continue;
      this.#memory.destroy(texture);
      this.#held.delete(geometry);
    }
    for (const [geometry, page] of needed)
      if (!this.#held.has(geometry))
        this.#held.set(geometry, this.#make(clouds[page.cloudIndex].cloud, page));
  }

  #make(cloud: RowCloud['cloud'], page: RowPage): HeldRows {
    const { length } = rowsOfPage(cloud, page);
    const size = { width: Math.min(length, LINE_TEXELS), height: Math.ceil(length / LINE_TEXELS) };
    const usage = GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST;
    const texture = this.#memory.createTexture({ label: 'frame rows', size, format: 'r32uint', usage });
    return { cloud, page, texture, view: texture.createView(), written: null };
  }

  bindingsOf(pageIndex: number): { readonly splatRows: GPUTextureView } | null {
    const page = this.#pages[pageIndex];
    return page && { splatRows: this.#held.get(page.geometry)!.view };
  }

  bytesOf(cloudIndex: number): number {
    const geometries = this.#pages.flatMap((page) => (page?.cloudIndex === cloudIndex ? page.geometry : []));
    return [...new Set(geometries)].reduce(
      (sum, geometry) => sum + this.#memory.bytesOf(this.#held.get(geometry)!.texture),
      0,
    );
  }

  write(): void {
    for (const held of this.#held.values()) {
      const { pool, version } = held.cloud;
      // In a pool, other splats take the place of splats.
      const rowsVersion = pool ? version : 0;
      if (held.written !== rowsVersion) this.#fill(held);
      held.written = rowsVersion;
    }
  }

  #fill({ cloud, page, texture }: HeldRows): void {
    const rows = rowsOfPage(cloud, page);
    const { width } = texture;
    const write = (line: number, size: [width: number, height: number]) => {
      const layout = { offset: 4 * width * line, bytesPerRow: 4 * width };
      this.#queue.writeTexture({ texture, origin: [0, line] }, rows, layout, size);
    };
    const lines = Math.floor(rows.length / width);
    write(0, [width, lines]);
    const rest = rows.length % width;
    if (rest > 0) write(lines, [rest, 1]);
  }
}

function rowsOfPage(
  { fileIndices }: RowCloud['cloud'],
  { isBlobs, splatStart, splatCount }: RowPage,
): Uint32Array {
  if (isBlobs || fileIndices.length === 0) return NO_ROWS;
  return fileIndices.subarray(splatStart, splatStart + Math.min(splatCount, LINE_TEXELS ** 2));
}
