/*!
 * The decoder is a part of meshoptimizer, https://github.com/zeux/meshoptimizer:
 *
 * MIT License
 *
 * Copyright (c) 2016-2026 Arseny Kapoulkine
 *
 * Permission is hereby granted, free of charge, to any person obtaining a copy
 * of this software and associated documentation files (the "Software"), to deal
 * in the Software without restriction, including without limitation the rights
 * to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
 * copies of the Software, and to permit persons to whom the Software is
 * furnished to do so, subject to the following conditions:
 *
 * The above copyright notice and this permission notice shall be included in all
 * copies or substantial portions of the Software.
 *
 * THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
 * IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
 * FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
 * AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
 * LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
 * OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
 * SOFTWARE.
 */
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import type { DecodeMeshopt } from './meshopt.ts';

/** See `DecodeMeshopt`. Rejects if WebAssembly is unavailable. */
export const decode: DecodeMeshopt = async ({ bytes, count, strideBytes, mode, filter }) => {
  if (!MeshoptDecoder.supported) throw new Error('there is no WebAssembly here');
  await MeshoptDecoder.ready;
  const unpacked = new Uint8Array(count * strideBytes);
  try {
    MeshoptDecoder.decodeGltfBuffer(unpacked, count, strideBytes, bytes, mode, filter);
  } catch {
    // Null: the caller names the damaged view.
    return null;
  }
  return unpacked;
};
