import { GpuLimitError, InvalidArgumentError, SplatFileError, SplatSourceError } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { reportFailure } from './failure-report.ts';

describe('reportFailure', () => {
  it('keeps the engine’s own words about a file', () => {
    const error = new SplatFileError('truncated', 'a.ply', 'cut off', { byte: 12 });
    const report = reportFailure(error, 'a.ply');
    expect(report).toMatchObject({ title: 'a.ply is incomplete', message: 'a.ply: cut off (byte 12)' });
    expect(report.isFault).toBeUndefined();
  });

  it.each([
    ['empty', 'the file is empty', { byte: 0 }, 'is empty', /^Check/],
    [
      'truncated',
      'it ends',
      { byte: 3e6, expectedBytes: 4_721_476 },
      'is incomplete',
      /^3.0 of 4.7 MB arrived.$/,
    ],
    [
      'truncated',
      'it ends',
      { byte: 4_721_471, expectedBytes: 4_721_476 },
      'is incomplete',
      /^The last 5 bytes are missing.$/,
    ],
  ] as const)(
    'says plainly of a file that it is %s, with the engine’s words below',
    (code, words, place, is, says) => {
      const error = new SplatFileError(code, 'a.txt', words, place);
      const report = reportFailure(error, 'a.txt');
      expect(report).toMatchObject({ title: `a.txt ${is}`, details: error.message });
      expect(report.message).toMatch(says);
    },
  );

  it('keeps the engine’s words about a file of which it does not say what it is', () => {
    const words = 'its rows have positions that no scene has.';
    const error = new SplatFileError('unknown-format', 'a.splat', words);
    expect(reportFailure(error, 'a.splat')).toMatchObject({
      title: 'a.splat cannot be read',
      message: `a.splat: ${words}`,
    });
  });

  it.each([
    [['is an image, not a splat file'], 'is an image, not a splat file', /^Opens PLY, /],
    [
      ['is a Git LFS pointer, not the file itself', 'run "git lfs pull" in its repository'],
      'is a Git LFS pointer, not the file itself',
      /^Run "git lfs pull" in its repository\.$/,
    ],
    [
      ['is a .ksplat of version 9.1', 'versions 0.1 and above are read'],
      'is a .ksplat of version 9.1',
      /^Versions 0\.1 and above are read\.$/,
    ],
    [
      ['is a mesh (1 face rows), not splats', 'its vertices lack scale_0. Train it'],
      'is a mesh, not splats',
      /^Its vertices lack scale_0\. Train it\.$/,
    ],
  ] as const)('names what was opened instead of splats: %o', (finding, is, says) => {
    const error = new SplatFileError('unknown-format', 'a.b: c.ply', finding, { byte: 0 });
    const report = reportFailure(error, 'a.b: c.ply');
    expect(report).toMatchObject({ title: `a.b: c.ply ${is}`, details: error.message });
    expect(report.message).toMatch(says);
  });

  it('leaves to the details what is too long for a title', () => {
    const error = new SplatFileError('unknown-format', 'a.zip', ['x'.repeat(100)]);
    expect(reportFailure(error, 'a.zip').title).toBe('a.zip cannot be read');
  });

  it('names the file that a server does not give', () => {
    expect(reportFailure(new SplatSourceError('a.ply', 'not found', 404), 'a.ply').title).toBe(
      'a.ply cannot be read',
    );
  });

  it('thinks of CORS only where there was no answer', () => {
    expect(reportFailure(new SplatSourceError('a.ply', 'no answer'), 'a.ply').advice).toContain('CORS');
    expect(reportFailure(new SplatSourceError('a.ply', 'not found', 404), 'a.ply').advice).not.toContain(
      'CORS',
    );
  });

  it('names what a GPU would need', () => {
    const error = new GpuLimitError('maxBufferSize', 2e9, 1e9, 'a.ply is too large.');
    expect(reportFailure(error, 'a.ply').message).toBe(
      'a.ply is too large. (2.0 GB needed, 1.0 GB available)',
    );
  });

  it('counts lengths as lengths', () => {
    const error = new GpuLimitError('maxTextureDimension2D', 9000, 8192, 'The image is too large.');
    expect(reportFailure(error, 'a.ply').message).toBe('The image is too large.');
  });

  it('takes what was not thrown on purpose for a fault', () => {
    expect(reportFailure(new InvalidArgumentError('far', 'far is 0'), 'a.ply').isFault).toBeUndefined();
    expect(reportFailure(new TypeError('x is undefined'), 'a.ply').isFault).toBe(true);
    expect(reportFailure('a string', 'a.ply').message).toBe('a string');
  });
});
