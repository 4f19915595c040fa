import { describe, expect, it } from 'vitest';
import { addressedScene, builtinSource, firstSource } from './first-source.ts';
import { titleOf } from './scene-source.ts';

const BASE = 'http://localhost/viewer/?x=1';

describe('first source', () => {
  it.each(['src', 'url', 'file'])('is the file of the address, as ?%s=, relative to the page', (name) => {
    const asked = addressedScene(new URLSearchParams(`${name}=a.ply&scene=hard:far-origin`));
    const { source, notice, failure } = firstSource(asked, BASE, true);
    expect(source).toEqual({ kind: 'url', url: new URL('http://localhost/viewer/a.ply') });
    expect([notice, failure]).toEqual([null, null]);
  });

  it('is all files of the address together', () => {
    const asked = addressedScene(new URLSearchParams('src=a.ply&src=/b.spz&src='));
    const { source } = firstSource(asked, BASE, true);
    const urls = [new URL('http://localhost/viewer/a.ply'), new URL('http://localhost/b.spz')];
    expect(source).toEqual({ kind: 'urls', urls });
    expect(titleOf(source)).toBe('a.ply and b.spz');
    expect(titleOf({ kind: 'urls', urls: [...urls, ...urls] })).toBe('a.ply, b.spz, and 2 more');
  });

  it('is the named scene where the file has no address, and says so', () => {
    const asked = { addresses: ['a.ply', 'http://['], scene: 'hard:far-origin' };
    const { source, failure } = firstSource(asked, BASE, true);
    expect(source).toEqual({ kind: 'hard-case', name: 'far-origin' });
    expect(failure?.message).toBe('“http://[” is not an address.');
    expect(failure?.advice).toContain('?src=');
  });

  it.each([
    [true, 'still-life-small'],
    [false, 'still-life'],
  ])('is the default scene without an address (software adapter: %s)', (isSoftware, name) => {
    expect(firstSource({}, BASE, isSoftware)).toMatchObject({
      source: { kind: 'builtin', scene: { name } },
      notice: null,
    });
  });

  it('is the default scene where there is none of that name, and says so', () => {
    const { source, notice } = firstSource({ scene: 'nowhere' }, BASE, true);
    expect(source).toMatchObject({ scene: { name: 'still-life-small' } });
    expect(notice).toBe('There is no built-in scene “nowhere”.');
  });

  it('takes the default scene in place of a hard case that failed, without a notice', () => {
    expect(builtinSource('hard:far-origin', false)).toMatchObject({
      source: { scene: { name: 'still-life' } },
      notice: null,
    });
  });
});
