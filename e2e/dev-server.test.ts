import { type AddressInfo, Server } from 'node:net';
import { fileURLToPath } from 'node:url';
import { createServer } from 'vite';
import { afterEach, expect, test, vi } from 'vitest';

afterEach(() => {
  vi.restoreAllMocks();
});

const LOOPBACK = ['127.0.0.1', '::1'];

/** Servers that the app's development server has begun to listen with. */
async function addressesOf(app: string): Promise<string[]> {
  const listening: Server[] = [];
  const listen = Server.prototype.listen;
  vi.spyOn(Server.prototype, 'listen').mockImplementation(function (this: Server, ...args: unknown[]) {
    listening.push(this);
    return Reflect.apply(listen, this, args);
  });
  const configFile = fileURLToPath(new URL(`../apps/${app}/vite.config.ts`, import.meta.url));
  const server = await createServer({ configFile, logLevel: 'error', server: { port: 0 } });
  try {
    await server.listen();
    // Others have tried whether a port is free, and are closed.
    const open = listening.filter((each) => each.listening);
    return open.map((each) => (each.address() as AddressInfo).address);
  } finally {
    await server.close();
  }
}

/**
 * @fault Pages and packages: another machine asks the server of `npm start`
 * @consequence it listens on this machine's own addresses alone, unless `--host` asks for others
 */
test.each(['viewer', 'lab'])('%s is served to this machine alone', async (app) => {
  const addresses = await addressesOf(app);
  expect(addresses.length).toBeGreaterThan(0);
  for (const address of addresses) expect(LOOPBACK).toContain(address);
});
