// What keeps the page once it has been loaded: all its files, of one version.

const worker = /** @type {any} */ (self);
const FILES_OF_PAGE = /** @type {any} */ ("FILES"); // both are filled in when the folder is written
const NAME = "fuzzyarm-page-" + "DIGEST";

worker.addEventListener("install", (event) => {
  const all = async () => (await caches.open(NAME)).addAll(FILES_OF_PAGE);
  event.waitUntil(all().then(() => worker.skipWaiting()));
});

worker.addEventListener("activate", (event) => {
  const tidy = async () => {
    for (const name of await caches.keys())
      if (name.startsWith("fuzzyarm-page-") && name !== NAME) await caches.delete(name);
    await worker.clients.claim();
  };
  event.waitUntil(tidy());
});

worker.addEventListener("fetch", (event) => {
  if (event.request.method !== "GET") return;
  const answer = async () => {
    const kept = await (await caches.open(NAME)).match(event.request, { ignoreSearch: true });
    return kept ?? fetch(event.request);
  };
  event.respondWith(answer());
});
