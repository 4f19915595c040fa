import { resolveAccuracy } from '@websplatter/core';
import { builtinScenes } from '@websplatter/scenes';
import { describe, expect, it } from 'vitest';
import { FRONT } from '../../camera/orbit-pose.fixture.ts';
import { FIRST_PATH } from '../../state/saved-view.ts';
import type { SceneSource } from '../open/scene-source.ts';
import {
  addressWithout,
  type LinkedView,
  linkTo,
  pageAddress,
  type UnmentionedView,
} from './page-address.ts';

const page = (text: string) => new URL(text, 'http://localhost/');
const first = {
  ...{ pose: FRONT, fovDegrees: 50, isOrthographic: false, cameraIndex: 0 },
  ...{ isFlipped: false, isZUp: false },
};
const moved = { ...first, pose: { ...FRONT, distance: 4, azimuth: 0.25, polar: 1 } };
const unmentioned: UnmentionedView = { camera: first, accuracy: resolveAccuracy() };
const [scene] = builtinScenes;
const builtin: SceneSource = { kind: 'builtin', scene };
const file: SceneSource = { kind: 'file', name: 'a.ply', source: new File([], 'a.ply') };
const url: SceneSource = { kind: 'url', url: page('/scenes/a.ply') };

function view(changes: Partial<LinkedView> = {}): LinkedView {
  return {
    sources: [builtin],
    looks: [],
    camera: first,
    accuracy: resolveAccuracy(),
    detail: null,
    comparison: null,
    effects: null,
    crop: null,
    viewMode: 'colours',
    background: 'theme',
    ...{ savedViews: [], path: FIRST_PATH, annotations: [] },
    ...changes,
  };
}
const tinted = 'tint:ff0000';
const written = (before: string, changes: Partial<LinkedView>) =>
  pageAddress(page(before), view(changes), unmentioned);

describe('the address of the page', () => {
  it('says nothing about what the page begins with', () => {
    expect(written('/', {})).toBe('/');
    expect(written('/x/?noui#top', {})).toBe('/x/?noui#top');
  });

  it('names the camera once it is another one, and with it the scene', () => {
    expect(written('/', { camera: moved })).toBe(`/?camera=0,0,0,4,0.25,1&scene=${scene.name}`);
    expect(written('/?camera=0,0,0,4,0.25,1', {})).toBe('/');
  });

  it('names an accuracy and a comparison', () => {
    const accuracy = resolveAccuracy({ preset: 'high', sortKeyBits: 16 });
    const comparison = {
      comparison: { kind: 'split', left: 'current', right: accuracy },
      splitPart: 0.25,
    } as const;
    expect(
      written('/?scene=hard:a,b#top', {
        sources: [{ kind: 'hard-case', name: 'a,b' }],
        accuracy,
        comparison,
      }),
    ).toBe('/?scene=hard:a,b&accuracy=high,sortKeyBits:16&compare=current/high,sortKeyBits:16/0.25#top');
    expect(written('/?accuracy=fast&compare=error', {})).toBe('/');
  });

  it('names a detail that was chosen, as a link does', () => {
    const detail = { maxSplats: 5000 };
    expect(written('/', { detail })).toBe('/?detail=maxSplats:5000');
    expect(written('/', { detail: 'full' })).toBe('/?detail=full');
    expect(written('/?detail=maxSplats:5000', {})).toBe('/');
    expect(linkTo(page('/'), view({ detail }))).toContain('&detail=maxSplats:5000');
    expect(linkTo(page('/?detail=maxSplats:5000'), view())).not.toContain('detail');
  });

  it('names a background that was chosen, as a link does', () => {
    expect(written('/', { background: '#000000' })).toBe('/?background=000000');
    expect(written('/?background=000', {})).toBe('/');
    expect(linkTo(page('/'), view({ background: '#ff8000' }))).toContain('&background=ff8000');
  });

  it('names effects that are on, and with them the scene', () => {
    expect(written('/', { effects: tinted })).toBe(`/?effects=tint:ff0000&scene=${scene.name}`);
    expect(written('/?effects=tint:ff0000', {})).toBe('/');
    expect(written('/?effects=tint:ff0000', { sources: [file], effects: tinted })).toBe('/');
    expect(written('/?src=gone.ply&effects=tint:ff0000', {})).toBe('/?src=gone.ply');
  });

  it('names a crop, and with it the scene', () => {
    const crop = { min: [-1, 0, 0.1], max: [1, 2, 3], keep: 'outside' } as const;
    const text = 'crop=-1:0:0.1:1:2:3:outside';
    expect(written('/', { crop })).toBe(`/?${text}&scene=${scene.name}`);
    expect(written(`/?${text}`, {})).toBe('/');
    expect(written(`/?${text}`, { sources: [file], crop })).toBe('/');
    expect(written(`/?src=gone.ply&${text}`, { crop })).toBe('/?src=gone.ply');
    expect(linkTo(page('/'), view({ crop }))).toContain(text);
  });

  it('names saved views and annotations, and with them the scene', () => {
    const saved = [moved, { ...first, fovDegrees: 30 }].map((each, i) => ({
      ...{ ...each, name: ['The door', ''][i], thumbnail: null },
    }));
    const text = 'view=0,0,0,4,0.25,1,name:The+door&view=0,0,0,10,0,1.5708,fov:30';
    const annotations = [{ ...{ title: 'Jug', text: 'Old' }, point: [0, 1, 2], view: first }] as const;
    expect(linkTo(page('/'), view({ annotations }))).toContain(
      '&annotation=0:1:2,0,0,0,10,0,1.5708,words:Jug%0AOld',
    );
    expect(written('/', { savedViews: saved })).toBe(`/?${text}&scene=${scene.name}`);
    expect(written(`/?${text}`, {})).toBe('/');
    expect(written(`/?${text}`, { sources: [file], savedViews: saved })).toBe('/');
    expect(written(`/?src=gone.ply&${text}`, { savedViews: saved })).toBe('/?src=gone.ply');
    expect(linkTo(page('/'), view({ savedViews: saved }))).toContain(text);
    const path = { isLooped: true, turntable: null };
    expect(written('/', { path })).toBe(`/?path=loop&scene=${scene.name}`);
    expect(written('/?path=loop', {})).toBe('/');
  });

  it('names the view mode', () => {
    expect(written('/', { viewMode: 'depth' })).toBe('/?mode=depth');
    expect(written('/?mode=depth', {})).toBe('/');
    expect(linkTo(page('/'), view({ viewMode: 'overdraw' }))).toContain('&mode=overdraw');
  });

  it('keeps addresses of files as they were written', () => {
    expect(written('/?src=scenes/a.ply', { sources: [url] })).toBe('/?src=scenes/a.ply');
    expect(written('/?url=scenes/a.ply', { sources: [url], camera: moved })).toBe(
      '/?url=scenes/a.ply&camera=0,0,0,4,0.25,1',
    );
    const urls = ['/a.ply', '/b.spz'].map((path): SceneSource => ({ kind: 'url', url: page(path) }));
    expect(written('/?src=a.ply&src=b.spz', { sources: urls })).toBe('/?src=a.ply&src=b.spz');
    expect(written('/?scene=still-life', { sources: urls })).toBe(
      '/?src=http://localhost/a.ply&src=http://localhost/b.spz',
    );
  });

  it('names the addresses that are left of several, and how files are drawn', () => {
    const [a, b] = ['/a.ply', '/b.ply'].map((path): SceneSource => ({ kind: 'url', url: page(path) }));
    const looks = ['', 'move:1:0:0'];
    expect(written('/?src=a.ply&src=b.ply', { sources: [b] })).toBe('/?src=b.ply');
    expect(written('/?src=a.ply', { sources: [a, b], looks })).toBe(
      '/?src=a.ply&src=http://localhost/b.ply&place&place=move:1:0:0',
    );
    expect(written('/?place=hidden:1', { looks: ['opacity:0.5'] })).toBe(
      `/?place=opacity:0.5&scene=${scene.name}`,
    );
    expect(written('/?src=a.ply&place=hidden:1', { sources: [a] })).toBe('/?src=a.ply');
    // No address can name all of them.
    expect(written('/?src=a.ply&place=hidden:1', { sources: [a, file], looks })).toBe('/');
  });

  it('names neither a scene nor a camera where a file of this device is shown', () => {
    expect(
      written('/?scene=still-life&camera=0,0,0,4,0.25,1&accuracy=fast', { sources: [file], camera: moved }),
    ).toBe('/');
    expect(written('/?src=a.ply', { sources: [file] })).toBe('/');
  });

  it('stays where a built-in scene stands for what could not be opened, so that a reload tries again', () => {
    expect(written('/?src=gone.ply&camera=0,0,0,4,0.25,1', { camera: moved })).toBe('/?src=gone.ply');
    expect(written('/?scene=hard:gone', {})).toBe('/?scene=hard:gone');
  });

  it('forgets files that are not opened, and with the last of them all that fits only the scene', () => {
    const rest = 'camera=0,0,0,4,0.25,1&effects=fog&crop=1&view=2&annotation=3&accuracy=fast&noui#top';
    const sources = (...names: string[]) =>
      names.map((name) => ({ kind: 'url', url: new URL(name, 'http://localhost/') }) as const);
    const forgotten = (address: string, ...names: string[]) =>
      addressWithout(page(address), sources(...names));
    expect(forgotten(`/?src=a.ply&place=x&${rest}`, 'a.ply')).toBe('/?accuracy=fast&noui#top');
    expect(forgotten('/?src=a.ply&url=b.ply&src=c.ply&place=x&place=y&place=z&camera=1', 'c.ply')).toBe(
      '/?camera=1&src=a.ply&url=b.ply&place=x&place=z',
    );
    const hardCase = { kind: 'hard-case', name: 'c' } as const;
    expect(addressWithout(page(`/?scene=hard:c&${rest}`), [hardCase])).toBe('/?accuracy=fast&noui#top');
  });
});

describe('a link', () => {
  it('tells everything, so that other devices show the same', () => {
    expect(linkTo(page('/x/#top'), view())).toBe(
      `http://localhost/x/?scene=${scene.name}&camera=0,0,0,10,0,1.5707963267948966&accuracy=balanced#top`,
    );
  });

  it('names the built-in scene that is shown, not the file that could not be opened', () => {
    const link = new URL(linkTo(page('/?src=gone.ply'), view()) ?? '');
    expect(link.searchParams.get('src')).toBeNull();
    expect(link.searchParams.get('scene')).toBe(scene.name);
  });

  it('tells the effects that are on', () => {
    const link = new URL(linkTo(page('/'), view({ effects: tinted })) ?? '');
    expect(link.searchParams.get('effects')).toBe('tint:ff0000');
  });

  it('is none to a file of this device', () => {
    expect(linkTo(page('/'), view({ sources: [file] }))).toBeNull();
    expect(linkTo(page('/'), view({ sources: [] }))).toBeNull();
    expect(linkTo(page('/'), view({ sources: [builtin, url] }))).toBeNull();
  });
});
