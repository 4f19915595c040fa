import { GpuLimitError, InvalidArgumentError, SplatFileError, SplatSourceError } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { reportFailure } from './failure-report.ts';

describe('reportFailure', () => {
  it('keeps the engine’s own words about a file', () => {
    const error = new SplatFileError('truncated', 'a.ply', 'cut off', { byte: 12 });
    const report = reportFailure(error, 'a.ply');
    expect(report).toMatchObject({ title: 'a.ply is incomplete', message: 'a.ply: cut off (byte 12)' });
    expect(report.isFault).toBe(false);
  });

  it.each([
    [
      'unknown-format',
      'the first bytes (68 65) are of no known format',
      {},
      'is not a splat file',
      /^Opens PLY, /,
    ],
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

  it('says what a file is that people open by mistake', () => {
    const error = new SplatFileError(
      'unknown-format',
      'a.ply',
      'there are bytes before its "ply" line; remove them.',
    );
    expect(reportFailure(error, 'a.ply')).toMatchObject({
      title: 'a.ply cannot be read',
      message: 'a.ply: there are bytes before its "ply" line; remove them.',
    });
  });

  it.each([
    [
      'unknown-format',
      'it is an image, not a splat file. Formats read: PLY, SPZ.',
      'is an image, not a splat file',
      /^Opens PLY, /,
    ],
    [
      'unknown-format',
      'it is a Git LFS pointer, not the file itself; run "git lfs pull" in its repository. Formats read: PLY.',
      'is a Git LFS pointer, not the file itself',
      /^Run "git lfs pull" in its repository\.$/,
    ],
    [
      'unknown-format',
      'it is a .ksplat of version 9.1; versions 0.1 and above are read.',
      'is a .ksplat of version 9.1',
      /^Versions 0\.1 and above are read\.$/,
    ],
    [
      'not-splats',
      'this is a mesh (1 face rows), not splats: its vertices lack scale_0. Splats come from training.',
      'is a mesh, not splats',
      /^Its vertices lack scale_0\. Splats come from training\.$/,
    ],
  ] as const)('names what was opened instead of splats: %s, %s', (code, words, is, says) => {
    const error = new SplatFileError(code, 'a.b: c.ply', words, { byte: 0 });
    const report = reportFailure(error, 'a.b: c.ply');
    expect(report).toMatchObject({ title: `a.b: c.ply ${is}`, details: error.message });
    expect(report.message).toMatch(says);
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
    expect(reportFailure(new InvalidArgumentError('far', 'far is 0'), 'a.ply').isFault).toBe(false);
    expect(reportFailure(new TypeError('x is undefined'), 'a.ply').isFault).toBe(true);
    expect(reportFailure('a string', 'a.ply').message).toBe('a string');
  });
});
