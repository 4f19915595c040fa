import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { encodePly, type SplatSet } from '@websplatter/core';
import { onTestFinished } from 'vitest';
import { main } from '../main.ts';

/** A temporary folder for one test, with helpers that write the files that commands read. */
export class TestFolder {
  readonly path = mkdtempSync(join(tmpdir(), 'websplatter-'));

  constructor() {
    onTestFinished(() => rmSync(this.path, { recursive: true, force: true }));
  }

  file(name: string): string {
    return join(this.path, name);
  }

  write(name: string, content: Uint8Array | string | object): string {
    const isContent = typeof content === 'string' || content instanceof Uint8Array;
    writeFileSync(this.file(name), isContent ? content : JSON.stringify(content));
    return this.file(name);
  }

  /** Writes a PLY, by default of `threeSplats`. */
  scene(name = 'scene.ply', set: SplatSet = threeSplats()): string {
    return this.write(name, encodePly(set));
  }

  /** Writes a camera that sees them. */
  camera(name = 'camera.json', changes: object = {}): string {
    return this.write(name, { position: [0, 0, 4], target: [0, 0, 0], fovYDegrees: 60, ...changes });
  }
}

/** Red, green and blue blobs in a row, with spherical harmonics of degree 1. */
export function threeSplats(): SplatSet {
  return {
    count: 3,
    origin: [0, 0, 0],
    positions: Float32Array.of(-1, 0, 0, 0, 0, 0.5, 1, 0, 0),
    logScales: new Float32Array(9).fill(Math.log(0.2)),
    rotations: Float32Array.of(1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0),
    opacityLogits: new Float32Array(3).fill(3),
    colorDc: Float32Array.of(1.5, -1.5, -1.5, -1.5, 1.5, -1.5, -1.5, -1.5, 1.5),
    harmonics: { degree: 1, coefficients: new Float32Array(27).fill(0.5) },
    fileIndices: Uint32Array.of(0, 1, 2),
    dropped: {},
  };
}

/**
 * A glTF with one splat whose attributes are all ones.
 *
 * @param properties of the extension, besides the required ones.
 * @param others further primitives.
 */
export function gltfOfOneSplat(properties: object = {}, others: readonly object[] = []): object {
  const types = {
    POSITION: 'VEC3',
    ROTATION: 'VEC4',
    SCALE: 'VEC3',
    OPACITY: 'SCALAR',
    SH_DEGREE_0_COEF_0: 'VEC3',
  };
  const names = Object.keys(types).map((name) =>
    name === 'POSITION' ? name : `KHR_gaussian_splatting:${name}`,
  );
  const extension = { kernel: 'ellipse', colorSpace: 'srgb_rec709_display', ...properties };
  const primitive = {
    mode: 0,
    attributes: Object.fromEntries(names.map((name, index) => [name, index])),
    extensions: { KHR_gaussian_splatting: extension },
  };
  const ones = Buffer.from(new Float32Array(4).fill(1).buffer).toString('base64');
  return {
    asset: { version: '2.0' },
    extensionsUsed: ['KHR_gaussian_splatting'],
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [primitive, ...others] }],
    buffers: [{ byteLength: 16, uri: `data:application/octet-stream;base64,${ones}` }],
    bufferViews: [{ buffer: 0, byteLength: 16 }],
    accessors: Object.values(types).map((type) => ({ bufferView: 0, componentType: 5126, count: 1, type })),
  };
}

/** Runs a command line in this process. */
export async function runMain(...args: string[]): Promise<{ status: number; out: string; err: string }> {
  let out = '';
  let err = '';
  const status = await main(args, {
    out: (text) => {
      out += text;
    },
    err: (text) => {
      err += text;
    },
  });
  return { status, out, err };
}
