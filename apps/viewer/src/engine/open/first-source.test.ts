import { describe, expect, it } from 'vitest';
import { addressedScene } from '../link/addressed-scene.ts';
import { builtinSource, firstSource } from './first-source.ts';
import { type SceneSource, titleOfAll } from './scene-source.ts';

const BASE = 'http://localhost/viewer/?x=1';

describe('first source', () => {
  it.each(['src', 'url', 'file'])('is the file of the address, as ?%s=, relative to the page', (name) => {
    const asked = addressedScene(new URLSearchParams(`${name}=a.ply&scene=hard:far-origin`));
    const { sources, notice, failure } = firstSource(asked, BASE, true);
    expect(sources).toEqual([{ kind: 'url', url: new URL('http://localhost/viewer/a.ply') }]);
    expect([notice, failure]).toEqual([null, null]);
  });

  it('is all files of the address together', () => {
    const asked = addressedScene(new URLSearchParams('src=a.ply&src=/b.spz&src='));
    const { sources } = firstSource(asked, BASE, true);
    const urls = [new URL('http://localhost/viewer/a.ply'), new URL('http://localhost/b.spz')];
    expect(sources).toEqual(urls.map((url) => ({ kind: 'url', url })));
    expect(titleOfAll(sources)).toBe('a.ply and b.spz');
    const ofFolders: SceneSource[] = ['lod-meta.json?x', 'a%20b/meta.json'].map((path) => ({
      kind: 'url',
      url: new URL(path, 'https://example.org/garden/'),
    }));
    expect(titleOfAll(ofFolders)).toBe('garden and a b');
    expect(titleOfAll([...sources, ...sources])).toBe('a.ply, b.spz, and 2 more');
  });

  /**
   * @fault Arguments: the viewer gets an invalid URL
   * @consequence the reason with a remedy, and the named scene
   */
  it('is the named scene where the file has no address, and says so', () => {
    const asked = { addresses: ['a.ply', 'http://['], scene: 'hard:far-origin' };
    const { sources, failure } = firstSource(asked, BASE, true);
    expect(sources).toEqual([{ kind: 'hard-case', name: 'far-origin' }]);
    expect(failure?.message).toBe('“http://[” is not an address.');
    expect(failure?.advice).toContain('?src=');
  });

  it.each([
    [true, 'still-life-small'],
    [false, 'still-life'],
  ])('is the default scene without an address (software adapter: %s)', (isSoftware, name) => {
    expect(firstSource({}, BASE, isSoftware)).toMatchObject({
      sources: [{ kind: 'builtin', scene: { name } }],
      notice: null,
    });
  });

  it('is the default scene where there is none of that name, and says so', () => {
    const { sources, notice } = firstSource({ scene: 'nowhere' }, BASE, true);
    expect(sources).toMatchObject([{ scene: { name: 'still-life-small' } }]);
    expect(notice).toBe('There is no built-in scene “nowhere”.');
  });

  it('takes the default scene in place of a hard case that failed, without a notice', () => {
    expect(builtinSource('hard:far-origin', false)).toMatchObject({
      sources: [{ scene: { name: 'still-life' } }],
      notice: null,
    });
  });
});
