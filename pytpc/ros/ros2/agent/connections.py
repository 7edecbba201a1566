"""Who speaks to whom on the graph, as a node of it knows."""

from typing import Any


def topics_of(node: Any) -> Any:
    """All topics: their types, and the nodes that publish and subscribe to them."""
    own = node.get_fully_qualified_name()

    def names(ends: Any) -> Any:
        found = {_full(end.node_name, end.node_namespace) for end in ends}
        return sorted(name for name in found if name != own and "_UNKNOWN_" not in name)

    return {
        topic: {
            "type": kinds[0] if len(kinds) == 1 else None,
            "publishers": names(node.get_publishers_info_by_topic(topic)),
            "subscribers": names(node.get_subscriptions_info_by_topic(topic)),
        }
        for topic, kinds in node.get_topic_names_and_types()
    }


def services_of(node: Any) -> Any:
    """All services, and the nodes that offer them; without those of nodes that have just gone."""
    own = node.get_fully_qualified_name()
    found: Any = {}
    for name, space in node.get_node_names_and_namespaces():
        full = _full(name, space)
        if full == own:
            continue
        try:
            services = node.get_service_names_and_types_by_node(name, space)
        except Exception:
            continue
        for service, _ in services:
            found.setdefault(service, set()).add(full)
    return {service: sorted(nodes) for service, nodes in found.items()}


def _full(name: Any, space: Any) -> Any:
    return space.rstrip("/") + "/" + name
