import { afterEach, expect, test, vi } from 'vitest';
import { rememberedRasterizer } from './remembered-rasterizer.ts';

afterEach(() => {
  vi.unstubAllGlobals();
});

test('stores one entry per adapter, as SECURITY.md says, for later pages', () => {
  const stored = new Map([['websplatter faster rasterizer acme two', 'quads']]);
  const localStorage = {
    getItem: (key: string) => stored.get(key) ?? null,
    setItem: (key: string, value: string) => void stored.set(key, value),
  };
  vi.stubGlobal('window', { localStorage });
  expect(rememberedRasterizer('acme two').remembered).toBe('quads');
  const { remembered, remember } = rememberedRasterizer('acme one');
  expect(remembered).toBeNull();
  remember('tiles');
  expect(stored.get('websplatter faster rasterizer acme one')).toBe('tiles');
  expect(stored.size).toBe(2);
});

test('remembers for this page where nothing may be stored', () => {
  vi.stubGlobal('window', {
    get localStorage(): Storage {
      throw new Error('The operation is insecure.');
    },
  });
  const { remembered, remember } = rememberedRasterizer('acme three');
  expect(remembered).toBeNull();
  remember('quads');
  expect(rememberedRasterizer('acme three').remembered).toBe('quads');
});
