import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { expectClose, FRONT } from '../camera/orbit-pose.fixture.ts';
import { type CameraAxes, poseOfAxes, quaternionOf } from '../camera/rotation.ts';
import { pathOf, viewOnPath } from '../navigate/view-path.ts';
import { settingsOfView } from '../share/settings-of-view.ts';
import { writeSceneSettings } from '../share/settings-section.tsx';
import { cameraAxes, lookAt, type OrbitPose } from '../state/orbit-pose.ts';
import type { SavedView } from '../state/saved-view.ts';
import { dot, scale, type Vec3 } from '../state/vec3.ts';
import { writeGltfPath } from './gltf-path.ts';
import { type FilePath, PathFileError, type PathScene, viewsOfPath } from './path-file.ts';
import { readPath, sampledPath } from './path-files.ts';

const SCENE: PathScene = {
  ...{ isFlipped: false, isZUp: false, isUpsideDown: false },
  ...{ aspect: 1.5, center: [0, 0, 0], radius: 5, fovDegrees: 50 },
};
/** Every way in which a scene may be drawn. */
const SCENES = [false, true].flatMap((isFlipped) =>
  [false, true].map((isZUp): PathScene => ({ ...SCENE, isFlipped, isZUp })),
);
const POSE: OrbitPose = { ...FRONT, target: [0.1, 0.2, -0.3], azimuth: 0.7, polar: 1.1 };
/** The same camera, rolled by a sixth of a turn. */
const ROLLED = poseOfAxes(lookAt(POSE).position, rolled(cameraAxes(POSE), Math.PI / 3), 10, [0, 1, 0]);

function rolled({ right, above, back }: CameraAxes, radians: number): CameraAxes {
  const [sine, cosine] = [Math.sin(radians), Math.cos(radians)];
  const mix = (a: Vec3, b: Vec3, of: number): Vec3 => [
    cosine * a[0] + of * sine * b[0],
    cosine * a[1] + of * sine * b[1],
    cosine * a[2] + of * sine * b[2],
  ];
  return { right: mix(right, above, 1), above: mix(above, right, -1), back };
}

const file = (name: string, content: BlobPart) => new File([content], name);
/** No file of these tests takes 10 s of CPU time, not even one of 100,000 lines or keys. */
async function read(scene: PathScene, ...files: File[]) {
  const start = process.cpuUsage();
  const { path } = await readPath(files, scene);
  expect(process.cpuUsage(start).user).toBeLessThan(10e6);
  return path;
}

/** What a camera shows: where it stands, and its axes. */
function expectSameCamera(actual: OrbitPose, expected: OrbitPose, tolerance: number): void {
  expectClose(lookAt(actual).position, lookAt(expected).position, tolerance * expected.distance);
  for (const axis of ['right', 'above', 'back'] as const)
    expectClose(cameraAxes(actual)[axis], cameraAxes(expected)[axis], tolerance);
}

const view = (pose: OrbitPose, change: Partial<SavedView> = {}): SavedView => ({
  ...{ pose, fovDegrees: 50, isOrthographic: false, isFlipped: false, isZUp: false },
  ...{ name: '', thumbnail: null, ...change },
});

/** A point or direction of the drawn scene in the scene's file: half a turn around x if it is flipped. */
const inFile = ([x, y, z]: Vec3, { isFlipped }: PathScene): Vec3 => (isFlipped ? [x, -y, -z] : [x, y, z]);

/** A line of `images.txt` for a camera, by COLMAP's definition, in float64. */
function colmapLine(pose: OrbitPose, scene: PathScene, name: string): string {
  const { right, above, back } = cameraAxes(pose);
  const [x, down, ahead] = [right, scale(above, -1), scale(back, -1)].map((axis) => inFile(axis, scene));
  const center = inFile(lookAt(pose).position, scene);
  // The rows of the rotation are the camera's axes: a turn the other way has them as columns.
  const [qx, qy, qz, qw] = quaternionOf({ right: x, above: down, back: ahead });
  const offset = [x, down, ahead].map((axis) => -dot(axis, center));
  return [1, qw, -qx, -qy, -qz, ...offset, 1, name].join(' ');
}

describe('images.txt of COLMAP', () => {
  it.each(SCENES)('has the cameras where they are in %j', async (scene) => {
    for (const pose of [POSE, ROLLED]) {
      const text = `# Image list with two lines of data per image:\n${colmapLine(pose, scene, 'a.jpg')}\n\n`;
      const { keys } = await read(scene, file('images.txt', text));
      expectSameCamera(keys[0].pose, pose, 1e-12);
    }
  });

  it('is ordered by names as people count, with fields of view of cameras.txt', async () => {
    const lines = ['img_10.jpg', 'img_9.jpg', 'sub/img 1.jpg'].map((name) => colmapLine(POSE, SCENE, name));
    const images = file('images.txt', lines.map((line) => `${line}\n1 2 -1 3 4 5`).join('\r\n'));
    const cameras = file('cameras.txt', '# Camera list\n1 PINHOLE 400 300 200 150 200 150\n');
    const { keys, notes } = await read(SCENE, cameras, images);
    expect(keys.map(({ name }) => name)).toEqual(['img_9', 'img_10', 'img 1']);
    expect(keys.map(({ atMs }) => atMs)).toEqual([0, 500, 1000]);
    expect(keys[0].fovDegrees).toBeCloseTo(90, 9);
    expect(notes).toEqual([]);
    const alone = await read(SCENE, images);
    expect([alone.keys[0].fovDegrees, alone.notes.length]).toEqual([50, 1]);
  });

  it('names the line that is none', async () => {
    const text = `${colmapLine(POSE, SCENE, 'a.jpg')}\n\n2 1 0 0 zero 1 1 1 1 b.jpg\n`;
    await expect(read(SCENE, file('images.txt', text))).rejects.toThrow(/images\.txt .*line 3 is not/);
    await expect(read(SCENE, file('images.txt', '1 0 0 0 0 1 1 1 1 b.jpg'))).rejects.toThrow('0, 0, 0, 0');
    await expect(read(SCENE, file('images.txt', '# IMAGE_ID, QW, QX\n'))).rejects.toThrow('no pictures');
  });
});

/**
 * @fault Files: a camera path has a hundred thousand blank lines, keys, nodes or channels
 * @consequence It is read in a time that grows with its length, or refused.
 */
describe('a long camera path', () => {
  const MANY = 100_000;
  const blank = '\n'.repeat(MANY);

  it('of COLMAP is told from other text, and read, at once', async () => {
    await expect(read(SCENE, file('notes.txt', blank))).rejects.toThrow('neither images.txt');
    await expect(read(SCENE, file('notes.txt', '1'.repeat(MANY)))).rejects.toThrow('neither images.txt');
    const line = colmapLine(POSE, SCENE, 'a.jpg');
    const cameras = file('cameras.txt', `${blank}1 PINHOLE 400 300 200 150 200 150${blank}`);
    const { keys } = await read(SCENE, file('images.txt', `${blank}${line}\n\n${line}${blank}`), cameras);
    expect(keys.map(({ fovDegrees }) => Math.round(fovDegrees))).toEqual([90, 90]);
  });

  const gltfOf = (nodes: readonly object[], channels: readonly object[], times: Float32Array) => {
    const positions = Float32Array.from({ length: 3 * times.length }, (_, i) => (i % 3 === 0 ? i / 3 : 0));
    const binary = new Uint8Array(16 * times.length);
    binary.set(new Uint8Array(times.buffer));
    binary.set(new Uint8Array(positions.buffer), 4 * times.length);
    const accessors = [
      { bufferView: 0, componentType: 5126, count: times.length, type: 'SCALAR' },
      { bufferView: 0, byteOffset: 4 * times.length, componentType: 5126, count: times.length, type: 'VEC3' },
    ];
    const json = {
      ...{ nodes, cameras: [{}], accessors, bufferViews: [{ buffer: 0 }] },
      buffers: [{ uri: `data:;base64,${Buffer.from(binary).toString('base64')}` }],
      animations: [{ samplers: [{ input: 0, output: 1 }], channels }],
    };
    return file('a.gltf', JSON.stringify(json));
  };
  const move = (node: number) => ({ sampler: 0, target: { node, path: 'translation' } });
  const ascending = (length: number) => Float32Array.from({ length }, (_, i) => i);

  it('of glTF has as many times as it has', async () => {
    const { keys } = await read(SCENE, gltfOf([{ camera: 0 }], [move(0)], ascending(MANY)));
    expect(keys).toHaveLength(MANY);
    expectClose(lookAt(keys[1234].pose).position, [1234, 0, 0], 1e-9);
  });

  it('of glTF may have many cameras, and many channels of the same numbers', async () => {
    const nodes = Array.from({ length: 30_000 }, () => ({ camera: 0 }));
    const channels = nodes.map((_, i) => move(i));
    expect((await read(SCENE, gltfOf(nodes, channels, ascending(5000)))).keys).toHaveLength(5000);
    expect((await read(SCENE, gltfOf(nodes, [], ascending(1)))).keys).toHaveLength(30_000);
  });

  it('of glTF is refused if its nodes are too deep, or a few bytes count as many values', async () => {
    const nodes = Array.from({ length: 100_000 }, (_, i) =>
      i === 0 ? { camera: 0 } : { children: [i - 1] },
    );
    await expect(read(SCENE, gltfOf(nodes, [move(0)], ascending(2)))).rejects.toThrow('nodes above it');
    const text = await gltfOf([{ camera: 0 }], [move(0)], ascending(2)).text();
    for (const byteStride of [0, -4, 0.5, '4'])
      await expect(
        read(
          SCENE,
          file(
            'a.gltf',
            text
              .replaceAll('"count":2', '"count":1000000000')
              .replace('"bufferViews":[{', `"bufferViews":[{"byteStride":${JSON.stringify(byteStride)},`),
          ),
        ),
      ).rejects.toThrow('byteStride');
  });

  it('has cameras that float32 can place', async () => {
    const far = colmapLine({ ...POSE, target: [1e300, 0, 0] }, SCENE, 'a.jpg');
    await expect(read(SCENE, file('images.txt', far))).rejects.toThrow('line 1 is farther away');
    const nodes = [
      { scale: [1e30, 1e30, 1e30], children: [1] },
      { camera: 0, translation: [1e30, 0, 0] },
    ];
    await expect(read(SCENE, gltfOf(nodes, [], ascending(1)))).rejects.toThrow('node 1 is farther away');
    const outside = [{ camera: 0, translation: [1e300, 0, 0] }];
    await expect(read(SCENE, gltfOf(outside, [], ascending(1)))).rejects.toThrow('nodes[0].translation');
  });
});

describe('glTF', () => {
  const path = pathOf({
    savedViews: [view(POSE, { toNextMs: 1500 }), view({ ...POSE, azimuth: 2, distance: 4 }), view(ROLLED)],
    path: { isLooped: false, turntable: null },
  })!;

  it.each(SCENES)('has the path as it is in %j, up to float32', async (scene) => {
    for (const kind of ['gltf', 'glb']) {
      const blob = writeGltfPath(sampledPath(path), 50, scene, kind === 'glb');
      const back = await read(scene, file(`path.${kind}`, blob));
      expect(back.durationMs).toBeCloseTo(path.durationMs, 3);
      for (const { atMs, pose, fovDegrees } of back.keys) {
        expectSameCamera(pose, viewOnPath(path, atMs).pose, 3e-6);
        expect(fovDegrees).toBeCloseTo(50, 9);
      }
    }
  });

  it('is what the specification says: y up, the camera along −z, and a valid container', async () => {
    const blob = writeGltfPath(sampledPath(path), 50, SCENE, true);
    const bytes = new DataView(await blob.arrayBuffer());
    expect([0, 4, 8].map((at) => bytes.getUint32(at, true))).toEqual([0x46546c67, 2, blob.size]);
    expect(blob.size % 4).toBe(0);
    const json = JSON.parse(await writeGltfPath(sampledPath(path), 50, SCENE, false).text());
    const [node] = json.nodes;
    expectClose(node.translation, lookAt(POSE).position, 1e-6);
    const [x, y, z, w] = node.rotation;
    // Of (0, 0, 1) turned by the quaternion: what the camera looks away from.
    expectClose(
      [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
      cameraAxes(POSE).back,
      1e-6,
    );
    expect(json.cameras[0].perspective.yfov).toBeCloseTo((50 * Math.PI) / 180, 9);
    expect(json.accessors[0]).toMatchObject({ min: [0], max: [4], type: 'SCALAR' });
  });

  it('is read with parents, cubic splines and steps, as programs write them', async () => {
    const floats = (...values: number[]) => {
      const bytes = new Uint8Array(Float32Array.from(values).buffer);
      return `data:application/octet-stream;base64,${btoa(String.fromCharCode(...bytes))}`;
    };
    const values = [
      ...[0, 2],
      // Before, value and after, for two times.
      ...[0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 3, 0, 0, 0, 0, 0],
    ];
    const gltf = {
      asset: { version: '2.0' },
      nodes: [
        { name: 'Empty', children: [1], rotation: [0, Math.SQRT1_2, 0, Math.SQRT1_2] },
        { name: 'Rig', children: [2], scale: [2, 2, 2] },
        { name: 'Eye', camera: 0, translation: [0, 1, 0] },
      ],
      cameras: [{ type: 'perspective', perspective: { yfov: 1, znear: 0.1 } }],
      animations: [
        {
          samplers: [{ input: 0, output: 1, interpolation: 'CUBICSPLINE' }],
          channels: [{ sampler: 0, target: { node: 1, path: 'translation' } }],
        },
      ],
      accessors: [
        { bufferView: 0, componentType: 5126, count: 2, type: 'SCALAR' },
        { bufferView: 0, byteOffset: 8, componentType: 5126, count: 6, type: 'VEC3' },
      ],
      bufferViews: [{ buffer: 0, byteLength: 80 }],
      buffers: [{ byteLength: 80, uri: floats(...values) }],
    };
    const { keys, durationMs } = await read(SCENE, file('a.gltf', JSON.stringify(gltf)));
    expect(durationMs).toBe(2000);
    // x of the rig becomes −z by a quarter of a turn around y; the eye is twice as high.
    expectClose(lookAt(keys[0].pose).position, [0, 2, -1], 1e-6);
    expectClose(lookAt(keys[1].pose).position, [0, 2, -3], 1e-6);
    expectClose(cameraAxes(keys[0].pose).back, [1, 0, 0], 1e-6);
    const still = { ...gltf, animations: [] };
    expect((await read(SCENE, file('a.gltf', JSON.stringify(still)))).keys).toMatchObject([{ name: 'Eye' }]);
  });

  it.each([
    ['{', 'does not hold JSON'],
    ['{}', 'no node with a camera'],
    ['{"nodes":[{"camera":0}]}', 'cameras[0] is missing'],
    ['{"nodes":[{"camera":0,"children":[0]}],"cameras":[{}]}', 'its own ancestor'],
    ['{"nodes":1}', 'nodes is not a list'],
    [
      '{"nodes":[{"camera":0}],"cameras":[{}],"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"rotation"}}],"samplers":[{"input":0,"output":0}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":1,"type":"SCALAR"}],"bufferViews":[{"buffer":0}],"buffers":[{"uri":"a.bin"}]}',
      'in another file, a.bin',
    ],
  ])('%s is refused: %s', async (text, why) => {
    const reading = read(SCENE, file('a.gltf', text));
    await expect(reading).rejects.toThrow(PathFileError);
    await expect(reading).rejects.toThrow(why);
  });

  it('of any bytes is a path or a typed error', async () => {
    const whole = new Uint8Array(await writeGltfPath(sampledPath(path), 50, SCENE, true).arrayBuffer());
    await fc.assert(
      fc.asyncProperty(
        fc.nat(whole.length - 1),
        fc.nat(255),
        fc.nat(whole.length),
        async (at, value, length) => {
          const bytes = whole.slice(0, length);
          if (at < length) bytes[at] = value;
          await read(SCENE, file('a.glb', bytes)).catch((error: unknown) => {
            expect(error).toBeInstanceOf(PathFileError);
          });
        },
      ),
      { numRuns: 300 },
    );
  });
});

describe('settings.json of SuperSplat', () => {
  const saved = [view(POSE), view({ ...POSE, azimuth: 2, distance: 4 })];
  const path = pathOf({ savedViews: saved, path: { isLooped: true, turntable: null } })!;
  const settings = writeSceneSettings(
    settingsOfView(saved[0], path, [], { isUpsideDown: false, aspect: 1.5, background: [0, 0, 0] }),
  );

  it('has the path as it is, a loop too', async () => {
    const back = await read(SCENE, file('settings.json', settings));
    expect(back).toMatchObject({ isLooped: true, durationMs: 5000 });
    for (const { atMs, pose, fovDegrees } of back.keys) {
      expectSameCamera(pose, viewOnPath(path, atMs).pose, 1e-9);
      expect(fovDegrees).toBeCloseTo(50, 9);
    }
  });

  it('is read where the movement does not begin by itself, and the scene is turned', async () => {
    const quiet = JSON.stringify({ ...JSON.parse(settings), startMode: 'default' });
    const turned = await read({ ...SCENE, isFlipped: true }, file('settings.json', quiet));
    const [x, y, z] = lookAt(POSE).position;
    expectClose(lookAt(turned.keys[0].pose).position, [x, -y, -z], 1e-9);
  });

  it.each([
    ['{"version":3}', 'version is 3'],
    ['{"version":2,"animTracks":[]}', 'animTracks are empty'],
    ['{', 'must be JSON'],
  ])('%s is refused: %s', async (text, why) => {
    const reading = read(SCENE, file('settings.json', text));
    await expect(reading).rejects.toThrow(PathFileError);
    await expect(reading).rejects.toThrow(why);
  });
});

it('another file is refused by its name', async () => {
  await expect(read(SCENE, file('notes.txt', 'Hello'))).rejects.toThrow(/^notes\.txt .*neither images\.txt/);
});

it('long paths become as many views as are kept, at even distances, with all their time', () => {
  const keys = Array.from({ length: 301 }, (_, i) => ({
    ...{ atMs: (i * 1000) / 30, pose: { ...POSE, azimuth: i / 50 }, fovDegrees: 50 },
  }));
  const path: FilePath = { keys, durationMs: 10_000, isLooped: false, notes: [] };
  const views = viewsOfPath(path, SCENE, { most: 50, leastStepMs: 100 });
  expect(views).toHaveLength(50);
  const read = pathOf({ savedViews: views, path: { isLooped: false, turntable: null } })!;
  expect(read.durationMs).toBe(10_000);
  for (let ms = 500; ms < 9500; ms += 33) {
    const { azimuth } = viewOnPath(read, ms).pose;
    expect(azimuth).toBeCloseTo((ms * 30) / 1000 / 50, 2);
  }
  expect(
    viewsOfPath({ ...path, keys: keys.slice(0, 1) }, SCENE, { most: 50, leastStepMs: 100 }),
  ).toHaveLength(1);
});
