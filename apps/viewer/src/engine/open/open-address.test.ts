import { describe, expect, it } from 'vitest';
import { addressIn } from './open-address.ts';

describe('addressIn', () => {
  it.each([
    ['https://a.example/b/scene.ply', 'https://a.example/b/scene.ply'],
    ['  HTTP://a.example/scene.spz\n', 'http://a.example/scene.spz'],
    ['# a title\r\nhttps://a.example/x.sog\r\nhttps://a.example/y.sog', 'https://a.example/x.sog'],
    ['a.example/scene.ply?token=1', 'https://a.example/scene.ply?token=1'],
    ['a.example:8080/scene.ply', 'https://a.example:8080/scene.ply'],
  ])('reads %j', (text, href) => {
    expect(addressIn(text)?.href).toBe(href);
  });

  it.each(['', 'scene.ply', 'two words', 'javascript:alert(1)', 'file:///a.ply', 'https://'])(
    'finds none in %j',
    (text) => {
      expect(addressIn(text)).toBeNull();
    },
  );
});
