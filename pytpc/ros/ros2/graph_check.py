"""Whether pytpc reaches a graph of ROS 2 from this shell, for `pytpc doctor`."""

from __future__ import annotations

from collections.abc import Mapping

from pytpc.base.errors import MissingToolError, TpcError
from pytpc.base.wording import many
from pytpc.ros.ros2.address import DOMAIN, RANGE, Ros2Address
from pytpc.ros.ros2.agent_process import Agent
from pytpc.ros.ros2.found_nodes import is_somebody, visible
from pytpc.ros.ros2.interpreter import HOW_TO
from pytpc.ros.which import VARIABLE, asked_ros, sign_of_ros2
from pytpc.workspace.doctor.finding import Finding, note, warning

_LAME = "record, mark, watch and sink do not work"


def check_ros2_graph(env: Mapping[str, str]) -> list[Finding]:
    """Become a node of the graph, look who is there, and leave; nothing where no ROS 2 is named."""
    sign = sign_of_ros2(env)
    asked = asked_ros(env)
    if asked == 1 or not (sign or asked):
        return []
    why = sign or f"{VARIABLE}=2"
    try:
        address = Ros2Address.of_env(env)
        agent = Agent(address, env)
    except MissingToolError as error:
        what = str(error).removesuffix(f"; {HOW_TO}")
        return [warning(f"{_LAME}: {why}, but {what}", mend=HOW_TO)]
    except TpcError as error:
        return [warning(f"{_LAME}: {error}", why)]
    try:
        nodes = visible(agent.wait_for_graph(is_somebody).nodes)
    finally:
        agent.close()
    about = agent.about
    found = [
        note(
            f"ROS 2 works ({why}): {about['rmw']}, domain {address.domain}, discovery"
            f" {env.get(RANGE) or 'as usual (SUBNET)'}, {many(len(nodes), 'node')} found",
            about["python"],
        )
    ]
    if not nodes:
        found.append(
            note(
                f"no node in domain {address.domain}",
                DOMAIN,
                "start the robot, or set the variables of its shell here",
            )
        )
    return found
