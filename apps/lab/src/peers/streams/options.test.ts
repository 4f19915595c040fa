import { expect, test } from 'vitest';
import { BenchError } from '../runner/bench-error.ts';
import { readOptions } from './options.ts';
import { chooseStreamPeers, withFiles } from './stream-peers.ts';

const read = (line: string) => readOptions(line.split(' '), '/here');

test('the options of the bench of streams have units', () => {
  expect(read('--bricks a.bricks --cameras c.json --pool-mb 2 --rate-mbit 50 --latency 40')).toMatchObject({
    files: { bricks: '/here/a.bricks' },
    camerasFile: '/here/c.json',
    maxSplats: 1e6,
    poolBytes: 2 << 20,
    bitsPerSecond: 50e6,
    latencyMs: 40,
  });
});

test.each([
  ['--cameras c.json', 'No scene: give --bricks, --sog and --rad, or some of them.'],
  ['--rad a.rad', 'Give --cameras or --scene.'],
  ['--rad a.rad --scene a.ply --latency x', '--latency has "x"; it takes whole numbers from 1 on.'],
])('%s is refused', (line, message) => {
  expect(() => read(line)).toThrow(new BenchError(message));
});

test('peers are those of the given files, and all in a pack', () => {
  const namesOf = (line: string) => chooseStreamPeers(read(line)).map(({ name }) => name);
  expect(namesOf('--sog a/lod-meta.json --scene a.ply')).toEqual([
    'websplatter-sog',
    'websplatter-react-sog',
    'playcanvas',
  ]);
  expect(namesOf('--pack folder')).toEqual([
    'websplatter',
    'websplatter-sog',
    'websplatter-react-sog',
    'websplatter-rad',
    'playcanvas',
    'spark',
  ]);
  const named = '--bricks a.bricks --cameras c.json --peers';
  expect(namesOf(`${named} websplatter?accuracy=fast`)).toEqual(['websplatter?accuracy=fast']);
  expect(() => namesOf(`${named} spark`)).toThrow('--peers has spark: give --rad.');
  expect(() => namesOf(`${named} floor`)).toThrow('--peers has "floor"; known are websplatter, ');
});

test('of a pack, peers without a file are left out; named ones must have it', () => {
  const packed = [{ name: 'websplatter' }, { name: 'playcanvas' }];
  const leftOf = (line: string) => withFiles(packed, read(line)).map(({ name }) => name);
  expect(leftOf('--sog a.json --cameras c.json')).toEqual(['playcanvas']);
  expect(() => leftOf('--rad a.rad --cameras c.json')).toThrow('websplatter is missing: give --bricks.');
  expect(() => leftOf('--sog a.json --cameras c.json --peers websplatter,playcanvas')).toThrow('--bricks');
});
