import { withinCpuTime } from '@websplatter/node/cpu-time';
import { expect, test } from 'vitest';
import { dispositionName } from './open-url.ts';

test.each([
  ['attachment; filename="scene.splat"', 'scene.splat'],
  ['attachment; filename=scene.splat', 'scene.splat'],
  ['inline;FileName = scene.splat ; size=3', 'scene.splat'],
  ['attachment; filename="a \\"b\\"; filename=c.splat"', 'a "b"; filename=c.splat'],
  ["attachment; filename*=UTF-8''Gie%C3%9Fen.splat", 'Gießen.splat'],
  [`attachment; filename="x.bin"; filename*=utf-8'de'%e2%82%ac%20rates.splat`, '€ rates.splat'],
  [`attachment; filename*=UTF-8''y.splat; filename="x.bin"`, 'y.splat'],
  ["attachment; filename*=iso-8859-1'en'%A3%20rates.splat", '£ rates.splat'],
  // What cannot be decoded leaves the other.
  [`attachment; filename*=UTF-8''%ff.ply; filename=z.splat`, 'z.splat'],
  [`attachment; filename*=shift-jis''a.ply; filename=z.splat`, 'z.splat'],
  ['attachment; name="filename=x.splat"', undefined],
  ['attachment', undefined],
  ['filename=x.splat', undefined],
  ['', undefined],
])('%s', (header, name) => {
  expect(dispositionName(header)).toBe(name);
});

test('long headers take no long time', async () => {
  for (const part of [';', '; filename', '; filename="', '; filename="\\', ' ', "; a*=utf-8'"])
    expect((await withinCpuTime(1000, () => dispositionName(part.repeat(20_000)))) ?? '').not.toContain(
      'filename*',
    );
});
