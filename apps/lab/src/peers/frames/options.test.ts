import { describe, expect, test } from 'vitest';
import { BenchError } from '../runner/bench-error.ts';
import { PEER_NAMES, sourcesFolder } from '../runner/peer-list.ts';
import { readOptions, USAGE } from './options.ts';

describe('the options of the peer bench', () => {
  test('have defaults', () => {
    const options = readOptions(['--synthetic', '10000,20000'], '/here');
    expect(options).toMatchObject({
      scenes: [],
      synthetic: [10_000, 20_000],
      camerasFile: null,
      size: { widthPx: 1920, heightPx: 1080 },
      pictureSize: { widthPx: 480, heightPx: 270 },
      rounds: 2,
      frames: 120,
      warmUpFrames: 20,
      jumps: 16,
      peers: 'all',
      isFromFile: false,
      isLoads: false,
      isByPass: false,
      takesPictures: true,
      timeLimitMs: 300_000,
      budgetMs: Infinity,
      isSoftware: false,
      outFolder: null,
      jsonFile: null,
      evidenceFile: null,
      installs: true,
      packFolder: null,
      sourcesFolder,
    });
  });

  test('need no scene to pack a bench', () => {
    expect(readOptions(['--pack', 'there'], '/here')).toMatchObject({
      scenes: [],
      packFolder: '/here/there',
    });
  });

  test('take paths from where the command was called', () => {
    const args = [
      '--scenes',
      'a.ply,/b.ply',
      '--cameras',
      'c.json',
      '--out',
      'pictures',
      '--json',
      'r.json',
      '--evidence',
      'e.json',
    ];
    expect(readOptions(args, '/here')).toMatchObject({
      scenes: ['/here/a.ply', '/b.ply'],
      camerasFile: '/here/c.json',
      outFolder: '/here/pictures',
      jsonFile: '/here/r.json',
      evidenceFile: '/here/e.json',
    });
  });

  test.each([
    [[], /No scene/],
    [['--synthetic', 'many'], /--synthetic has "many"/],
    [['--scenes', 'a.ply', '--size', '1920'], /--size has "1920"/],
    [['--scenes', 'a.ply', '--picture-size', '0x9'], /--picture-size has "0x9"/],
    [['--scenes', 'a.ply', '--rounds', '0'], /--rounds has "0"/],
    [['--scenes', 'a.ply', '--budget', 'all'], /--budget has "all"/],
    [['--scenes', 'a.ply', '--quick'], /--quick/],
    [['a.ply'], /a\.ply/],
  ])('%j is an error that names the option', (args, message) => {
    expect(() => readOptions(args, '/here')).toThrow(BenchError);
    expect(() => readOptions(args, '/here')).toThrow(message);
  });

  test('are all in the usage', () => {
    for (const name of PEER_NAMES) expect(USAGE).toContain(name);
  });
});
